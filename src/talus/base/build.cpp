#include "talus/base/machine.hpp"
#include "talus/base/portability.hpp"

namespace talus {

std::string build() { return std::string(compiler) + ", " + instructions; }

}  // namespace talus
