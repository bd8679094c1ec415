// Hertzian contacts with Mindlin's tangential stiffness (docs/validation.md: V2.18).

#include "sim/laws/tangential/mindlin.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "sim/accuracy/impacts.hpp"
#include "sim/laws/normal/hertz.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::mindlin_test {
namespace {

using test::validate;

std::string contact(double mu) {
  return "normal = \"hertz\"\ntangential = \"mindlin\"\nyoungs_modulus = 1e8\npoisson_ratio = 0.3\nmu = " +
         std::to_string(mu) + "\n";
}

// The ratio of tangential to normal stiffness at constant load is 2 (1 - nu)/(2 - nu) at every overlap.
TEST(Mindlin, StiffnessRatio) {
  const PairScale pair{.m_eff = 0.5, .r_eff = 0.25, .inv_m_t = 6};
  for (const double nu : {0.0, 0.3, 0.5})
    for (const double overlap : {1e-5, 1e-3}) {
      const HertzViscoelastic hertz{1e7, nu, 0};
      const MindlinSlider mindlin{1e7, nu, 0.6};
      const auto c_n = hertz.constants(pair);
      const auto c_t = mindlin.constants(pair);
      const double step = 1e-4 * overlap;
      const auto normal = [&](double at) {
        return HertzViscoelastic::force<double>(c_n.data(), at, 0.0, nullptr);
      };
      const double k_n = (normal(overlap + step) - normal(overlap - step)) / (2 * step);
      Tangent<double, 1> xi{{0.01 * overlap}};
      const Tangent<double, 1> rest{{0.0}};
      const double f_t =
          MindlinSlider::force<double>(c_t.data(), rest, normal(overlap), 0.0, xi, overlap).c[0];
      validate({"V2.18", fmt::format("k_t/k_n at constant load, nu = {}, overlap {}", nu, overlap),
                2 * (1 - nu) / (2 - nu), 1e-6, "Mindlin 1949"},
               -f_t / (0.01 * overlap) / k_n);
    }
}

// An elastic impact that slides throughout changes v_t by -2 mu v_n and R w by 2 mu v_n m R^2/I, at any
// stiffness. By Maw, Barber & Fawcett 1976, it slides throughout from psi_1 = 4 chi - 1 on,
// here v_t/v_n = 5.88 mu. A spring without partial slip sticks for an instant at the end, where the normal
// force vanishes.
TEST(Mindlin, GrossSlidingImpulseIsTwoMuNormalMomentum) {
  constexpr double kMu = 0.2, kDegrees = 70;
  for (const int dimension : {2, 3}) {
    const Scene scene = impact_scene(contact(kMu), dimension);
    const Impact impact = Impact::at(kDegrees, true);
    const auto outcomes = outcomes_by_steps({impact}, scene, {.integrator = "split", .n = 100.37}, 16)[0];
    double v_t = 0, rim = 0, e = 0;
    for (const Outcome& o : outcomes) {
      v_t += o.v_t / 16;
      rim += scene.radius * o.spin / 16;
      e += o.v_n / impact.v_n / 16;
    }
    const std::string in = dimension == 2 ? ", plane" : ", space";
    const double turned = 2 * kMu * impact.v_n / scene.inertia_factor;
    validate({"V2.18", "gross sliding at 70 degrees, v_t'" + in, impact.v_t - 2 * kMu * impact.v_n, 2e-4,
              "Maw, Barber & Fawcett 1976"},
             v_t);
    validate(
        {"V2.18", "gross sliding at 70 degrees, R |w'|" + in, turned, 4e-4, "Maw, Barber & Fawcett 1976"},
        std::abs(rim));
    validate({"V2.18", "the same, e" + in, 1, 2e-4, "closed form"}, e);
  }
}

// At 20 degrees the surfaces stick at first. Without partial slip there is no closed form. The reference is
// the limit of small steps, which the split integrator reaches at second order.
TEST(Mindlin, StickingImpactsConvergeAtSecondOrder) {
  const Scene scene = impact_scene(contact(0.3));
  const std::vector<Impact> impacts = {Impact::at(20, true), Impact::at(35, true), Impact::at(35, false)};
  std::vector<Outcome> limit;
  for (const auto& o : outcomes_by_steps(impacts, scene, {.integrator = "split", .n = 6400.37}, 1))
    limit.push_back(o[0]);
  const auto error = [&](double n) {
    return impact_errors(impacts, limit, scene, {.integrator = "split", .n = n}, 16).spin.rms;
  };
  const double coarse = error(50.37), fine = error(200.37);
  const double order = std::log(coarse / fine) / std::log(200.37 / 50.37);
  std::printf("rms error of R w'/v: %.2e at n = 50, %.2e at n = 200, order %.2f\n", coarse, fine, order);
  EXPECT_GT(order, 1.8);
  EXPECT_LT(order, 2.4);
  EXPECT_LT(coarse, 5e-3);
}

}  // namespace
}  // namespace twincell::sim::mindlin_test
