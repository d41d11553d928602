#ifndef TALUS_LAW_H
#define TALUS_LAW_H
/* The constitutive laws of talus for other programs.
 *
 * Signs: TENSION IS POSITIVE, in stresses and strains. (Element tests of the command line are compression-positive.)
 * Components: xx, yy, zz, xy, yz, zx. Shear strains are tensor components, half the engineering shear strain; only the
 *   columns of the tangent belong to engineering shear strains.
 * Units: SI, angles in rad; settings given as text have their unit, as in a case.
 *
 * The numbers are those of `talus element`, to the bit, on the same processor: both call the same compiled law.
 * No function throws, prints, or keeps anything between calls outside the objects that it is given. A talus_law does not
 * change after it is made, so that any number of threads may use it at once, each with states of its own.
 *
 * Functions that can fail return a talus_status. Their last two arguments are a buffer for the message and its size; the
 * message is cut to fit and ends with a zero; both may be 0. */

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Grows whenever a function is added; a function never changes its meaning. */
#define TALUS_LAW_INTERFACE 1

typedef enum talus_status {
  TALUS_OK = 0,
  TALUS_INPUT_ERROR = 2, /* an argument is wrong: the message says which, and what would be right */
  TALUS_FAILURE = 3      /* anything else: no memory, a defect of talus */
} talus_status;

/* What became of a point in a step. */
typedef enum talus_outcome {
  TALUS_ELASTIC = 0,
  TALUS_PLASTIC = 1,
  TALUS_ZERO_PRESSURE = 2, /* contacts carry nothing, grains still touch */
  TALUS_SEPARATED = 3,     /* grains have moved apart */
  TALUS_UNCONVERGED = 4    /* the stress is the best found: repeat with a shorter step */
} talus_outcome;

typedef enum talus_integrator {
  TALUS_MODIFIED_EULER = 0, /* explicit substeps with error control: that of `talus element` */
  TALUS_RETURN_MAPPING = 1, /* implicit, first order, never fails: that of runs */
  TALUS_FORWARD_EULER = 2   /* one explicit step */
} talus_integrator;

typedef struct talus_law talus_law;

/* A parameter or option of a law. */
typedef struct talus_setting {
  const char* key;
  const char* text; /* as in a case, "30 deg", "0.2", "mohr_coulomb"; or 0, and `number` counts */
  double number;    /* in SI units */
} talus_setting;

/* A part of a state, or a quantity that follows from it. The texts live as long as the law. */
typedef struct talus_field {
  const char* name;
  const char* unit; /* "1" if it has none */
  const char* meaning;
  int components; /* 1, or 6 for a symmetric tensor */
} talus_field;

/* What a law is before the first step. Fill it with talus_initial_defaults first. */
typedef struct talus_initial {
  double stress[6];             /* of enduring contacts [Pa] */
  double void_ratio;            /* of laws that have one */
  double kappa;                 /* accumulated plastic deviatoric strain; NaN: the least that carries the stress */
  double background_pressure;   /* [Pa], of mu_i */
  double strain_rate[6];        /* [1/s], of laws that remember it */
  double collisional_stress[6]; /* [Pa], of laws that remember it */
} talus_initial;

/* Result of a step. Works are those of a unit of present volume in this step [J/m3]. */
typedef struct talus_response {
  double stress[6];        /* total stress after the step [Pa] */
  double elastic_energy;   /* that unloading gives back [J/m3] */
  double work;             /* of the stress on the strain of this step */
  double plastic_work;     /* its part turned into heat by friction, or not stored by elasticity */
  double collisional_work; /* its part done against collisional stress */
  double stiffness;        /* K + 4/3 G [Pa], for the speed of compression waves */
  double viscosity;        /* [Pa s], for the viscous limit of an explicit time step */
  int outcome;             /* a talus_outcome */
  int reserved;
} talus_response;

/* ---- laws ------------------------------------------------------------------------------------------------------- */

/* Version of the library, "0.1.0". */
const char* talus_law_version(void);

/* Makes a law by name with its parameters and options. Wrong, missing and unknown settings are reported all at once, a line
 * each, with a suggestion for misspelt keys. Free the law with talus_law_free. */
talus_status talus_law_make(const char* name, const talus_setting* settings, size_t n_settings, talus_law** law, char* message,
                            size_t message_size);
void talus_law_free(talus_law* law);

/* Chooses how steps are integrated; before the law is shared between threads. Default: TALUS_MODIFIED_EULER, 1e-6.
 * `tolerance`: relative error of the stress that a substep of TALUS_MODIFIED_EULER may make, from 1e-12 to 0.1. */
talus_status talus_law_set_integrator(talus_law* law, talus_integrator integrator, double tolerance, char* message,
                                      size_t message_size);

/* Name of the law. */
const char* talus_law_name(const talus_law* law);

/* Numbers in a state, and the fields that they belong to, in this order. talus_law_state_field returns 0 beyond the last. */
size_t talus_law_state_size(const talus_law* law);
size_t talus_law_state_fields(const talus_law* law);
const talus_field* talus_law_state_field(const talus_law* law, size_t field);

/* Quantities that follow from a state (pressure, void ratio, inertial number, ...), as `talus element` reports them but
 * tension-positive, and how many numbers they are together. */
size_t talus_law_quantities_size(const talus_law* law);
size_t talus_law_quantities(const talus_law* law);
const talus_field* talus_law_quantity(const talus_law* law, size_t quantity);
/* Their values at a state and a strain rate (6 numbers, or 0 for rest). */
void talus_law_evaluate(const talus_law* law, const double* state, const double* strain_rate, double* values);

/* ---- states ----------------------------------------------------------------------------------------------------- */

/* No stress, no void ratio, kappa NaN. */
void talus_initial_defaults(talus_initial* initial);

/* Writes the state under the given stress: talus_law_state_size numbers. */
talus_status talus_law_initial_state(const talus_law* law, const talus_initial* initial, double* state, char* message,
                                     size_t message_size);

/* Moves a state through a step of length dt [s]. `strain`: increment. `strain_rate` at the end of the step [1/s]; 0: strain/dt.
 * With dt = 0 and no strain_rate the step is infinitely slow: only the rate-independent part of the law acts. `response`
 * may be 0. A state that is not finite stays so: check the stress. */
void talus_law_update(const talus_law* law, double* state, const double* strain, const double* strain_rate, double dt,
                      talus_response* response);

/* The same for n points: states, strains, strain_rates (or 0) and responses (or 0) lie one after the other. The same bits as
 * talus_law_update point by point; eight points are computed at a time. */
void talus_law_update_many(const talus_law* law, size_t n, double* states, const double* strains, const double* strain_rates,
                           double dt, talus_response* responses);

/* Moves a state through a step and writes the consistent tangent: tangent[6*i + j] = d stress_i/d strain_j [Pa] over the
 * step, strain_j being 2 eps_xy, 2 eps_yz, 2 eps_zx for j = 3, 4, 5; not symmetric in general. The rate changes by
 * d strain/dt if dt > 0. By differences of talus_law_update: relative error below 1e-7. */
void talus_law_update_with_tangent(const talus_law* law, double* state, const double* strain, const double* strain_rate, double dt,
                                   talus_response* response, double* tangent);

/* Stress of a state [Pa], energy that unloading gives back [J/m3], and the volume over that of the grains (1 + void ratio) or,
 * of laws without grains, over that at the start. */
void talus_law_stress(const talus_law* law, const double* state, double* stress);
double talus_law_elastic_energy(const talus_law* law, const double* state);
double talus_law_specific_volume(const talus_law* law, const double* state);

/* Rotates the tensors of a state, A becomes Q A Q^T; Q[3*i + j] is row i, column j. Strains of talus_law_update are in the
 * frame that turns with the material: rotate the state first. */
void talus_law_rotate(const talus_law* law, double* state, const double* Q);

#ifdef __cplusplus
}
#endif
#endif
