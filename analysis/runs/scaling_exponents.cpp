#include "analysis/runs/scaling_exponents.hpp"

#include <cstdlib>
#include <sstream>

namespace twincell::analysis {

namespace {

/// The power of sigma in a word such as "sigma^2".
double power_of_word(const std::string& word) {
  const std::size_t caret = word.find('^');
  const std::string name = word.substr(0, caret);
  const double exponent = caret == std::string::npos ? 1 : std::strtod(word.c_str() + caret + 1, nullptr);
  return name == "sigma" ? exponent : name == "t0" ? exponent / 2 : 0;
}

}  // namespace

double length_power(const std::string& unit) {
  double power = 0, sign = 1;
  std::stringstream factors(unit);
  for (std::string part; std::getline(factors, part, '/'); sign = -1) {
    std::stringstream words(part);
    for (std::string word; words >> word && word != "per";) power += sign * power_of_word(word);
  }
  return power;
}

double length_power(const Result& result, int dimension) {
  return named_result(result.name).filling ? -dimension : length_power(result.unit);
}

double amplitude_power(const Result& result) {
  return -named_result(result.name).over_peak_velocity;
}

}  // namespace twincell::analysis
