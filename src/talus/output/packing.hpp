#pragma once
/// Numbers of particles packed for the browser, which unpacks them in report/viewer.js.

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace talus {

struct Packed {
  std::string words;     ///< 16 bits a number
  nlohmann::json facts;  ///< their scale
};

/// Half precision times 2^exponent, so that the largest magnitude lies in [2^14, 2^15) and what is 1e-8 of it still has
/// all its bits. Two of its eleven bits are rounded away: noise in them would make a page a quarter larger.
Packed packed_values(const std::vector<double>& values);

/// 16 bits between the least and the most.
Packed packed_places(const std::vector<double>& values);

/// Least, 1st and 99th percentile, most of the finite values; null if there are none.
nlohmann::json range_of(std::vector<double> values);

}  // namespace talus
