#pragma once
/// How many threads a command uses.

namespace talus {

/// The number of threads for a command; 0 if the user gave none. More threads than processors wait for each other and
/// slow a run down a hundredfold: they are reduced to the number of processors, with a warning, unless they are forced.
int usable_threads(int asked, bool forced);

}  // namespace talus
