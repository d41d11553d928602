#pragma once
/// The bodies of a case, filled with particles at rest.

#include "talus/mpm/data/body.hpp"
#include "talus/mpm/start/filling.hpp"
#include "talus/mpm/start/overburden.hpp"

namespace talus {

/// What particles of a body remember whose law has so many numbers of state.
ParticleMemory memory_of(const Numerics& numerics, int n_state, int n_loads, bool flows);

/// About how much memory a share of the particles of a case takes while it runs, and a snapshot of all of them [bytes].
double estimated_bytes(const Case& case_, double share = 1);

/// A part of body `number` of a case. The particles of the body are numbered from `first_id` on. Throws InputError if it has
/// none or cannot rest.
template <int Dim>
Body<Dim> make_body(const Case& case_, int number, const Overburden& overburden, long first_id, Part part = {});

}  // namespace talus
