/* Follows a strain path with a law and prints the stress after every step, a line each: xx yy zz xy yz zx [Pa], tension-positive.
 *
 * path_in_c FILE INTEGRATOR, with INTEGRATOR = modified_euler, return_mapping or forward_euler. FILE has: the name of the law; the number of settings; a line `key text` for each; the stress at the start
 * (six numbers), the void ratio and the background pressure; the number of steps; a line `dt strain[6] strain_rate[6]` for
 * each. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <talus/law.h>

static void fail(const char* what, const char* message) {
  fprintf(stderr, "%s: %s\n", what, message);
  exit(2);
}

static void read_numbers(FILE* file, int n, double* numbers) {
  for (int i = 0; i < n; ++i)
    if (fscanf(file, "%lf", numbers + i) != 1) fail("path", "a number is missing");
}

int main(int argc, char** argv) {
  FILE* file = argc > 1 ? fopen(argv[1], "r") : 0;
  if (!file) fail("path", "cannot be opened");
  char name[64], keys[64][64], texts[64][64], message[2000];
  talus_setting settings[64];
  int n_settings, n_steps;
  if (fscanf(file, "%63s %d ", name, &n_settings) != 2 || n_settings > 64) fail("path", "no law");
  for (int i = 0; i < n_settings; ++i) {
    if (fscanf(file, "%63s %63[^\n] ", keys[i], texts[i]) != 2) fail("path", "a setting is missing");
    settings[i].key = keys[i];
    settings[i].text = texts[i];
  }
  talus_law* law;
  if (talus_law_make(name, settings, (size_t)n_settings, &law, message, sizeof message) != TALUS_OK) fail(name, message);
  const char* integrators[] = {"modified_euler", "return_mapping", "forward_euler"};
  for (int i = 0; i < 3; ++i)
    if (argc > 2 && !strcmp(argv[2], integrators[i]) &&
        talus_law_set_integrator(law, (talus_integrator)i, 1e-6, message, sizeof message) != TALUS_OK)
      fail(name, message);

  talus_initial initial;
  double values[13];
  talus_initial_defaults(&initial);
  read_numbers(file, 6, initial.stress);
  read_numbers(file, 1, &initial.void_ratio);
  read_numbers(file, 1, &initial.background_pressure);
  double* state = malloc(talus_law_state_size(law) * sizeof(double));
  if (talus_law_initial_state(law, &initial, state, message, sizeof message) != TALUS_OK) fail(name, message);

  if (fscanf(file, "%d", &n_steps) != 1) fail("path", "no steps");
  for (int step = 0; step < n_steps; ++step) {
    talus_response r;
    read_numbers(file, 13, values);
    talus_law_update(law, state, values + 1, values + 7, values[0], &r);
    for (int i = 0; i < 6; ++i) printf("%.17g%c", r.stress[i], i < 5 ? ' ' : '\n');
  }
  free(state);
  talus_law_free(law);
  fclose(file);
  return 0;
}
