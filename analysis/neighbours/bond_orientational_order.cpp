#include "analysis/neighbours/bond_orientational_order.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/constants.hpp"

namespace twincell::analysis {
namespace {

/// a_m = (4 pi/13) |Y_6m(pi/2, 0)|^2 for m = 0, 2, 4, 6. The terms of odd m vanish in the plane. The Y_lm of
/// the standard library have the same normalisation as Steinhardt's definition.
const std::array<double, 4>& planar_weights() {
  static const std::array<double, 4> weights = [] {
    std::array<double, 4> a{};
    for (unsigned h = 0; h < 4; ++h) {
      const double y = std::sph_legendre(6, 2 * h, std::numbers::pi / 2);
      a[h] = 4 * std::numbers::pi / 13 * y * y;
    }
    return a;
  }();
  return weights;
}

}  // namespace

BondOrder bond_order(const Neighbours& neighbours, const std::vector<double>& weight) {
  const std::size_t n = neighbours.first.size() - 1;
  const std::vector<double> none(n, kNaN);
  BondOrder order{none, none, none, none, std::vector<std::size_t>(n, 0)};
  const auto& a = planar_weights();
  for (std::size_t i = 0; i < n; ++i) {
    order.n_bonds[i] = neighbours.count(i);
    if (order.n_bonds[i] < 2) continue;
    std::complex<double> sum2 = 0, sum4 = 0, sum6 = 0;
    double total = 0;
    for (std::size_t e = neighbours.first[i]; e < neighbours.first[i + 1]; ++e) {
      const double x = neighbours.bond[e].x(), z = neighbours.bond[e].z();
      const double w = weight.empty() ? 1.0 : weight[e];
      // exp(2 i phi) follows from x and z without a square root.
      const double norm = x * x + z * z;
      const std::complex<double> e2((x * x - z * z) / norm, 2 * x * z / norm);
      const std::complex<double> e4 = e2 * e2;
      total += w;
      sum2 += w * e2;
      sum4 += w * e4;
      sum6 += w * e4 * e2;
    }
    order.psi4[i] = std::abs(sum4) / total;
    order.psi6[i] = std::abs(sum6) / total;
    order.angle[i] = lattice_angle(sum6.real(), sum6.imag());
    order.q6[i] =
        std::sqrt(a[0] + 2 * (a[1] * std::norm(sum2) + a[2] * std::norm(sum4) + a[3] * std::norm(sum6)) /
                             (total * total));
  }
  return order;
}

double lattice_angle(double real, double imaginary) {
  const double degrees = std::atan2(imaginary, real) / 6 * 180 / std::numbers::pi;
  return degrees < kLowestOrientation ? degrees + kLatticePeriodDegrees : degrees;
}

double misorientation(double angle, double other) {
  return std::abs(std::remainder(angle - other, kLatticePeriodDegrees));
}

Structure structure_of(const BondOrder& order, std::size_t bead) {
  const double q6 = order.q6[bead];
  if (std::isnan(q6)) return Structure::undefined;
  if (order.n_bonds[bead] == 6 && std::abs(q6 - 0.741) < 0.05) return Structure::hexagonal;
  if (order.n_bonds[bead] == 4 && std::abs(q6 - 0.586) < 0.03) return Structure::square;
  return Structure::other;
}

}  // namespace twincell::analysis
