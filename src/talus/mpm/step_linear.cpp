#include "talus/mpm/step.hpp"

namespace talus {

template std::unique_ptr<Simulation> make_stepper(const Domain<2>&, std::vector<Body<2>>, std::vector<Linear>,
                                                  const Vec<2>&, const Numerics&, Backend&, std::vector<Solid>);
template std::unique_ptr<Simulation> make_stepper(const Domain<3>&, std::vector<Body<3>>, std::vector<Linear>,
                                                  const Vec<3>&, const Numerics&, Backend&, std::vector<Solid>);

}  // namespace talus
