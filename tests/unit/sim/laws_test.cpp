/// \file
/// What a contact law must declare, shown by laws that the program does not have.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/laws/axes.hpp"

namespace twincell::sim::laws_test {
namespace {

/// A law with the members of NormalLaw and no other: a force that is k delta whatever the speed.
struct BareSpring {
  static constexpr std::string_view kWord = "bare", kName = "bare spring", kHelp = "no dashpot";
  static constexpr std::array<const char*, 1> kKeys = {"stiffness"};
  static constexpr int kConstants = 1, kMemory = 0;
  double stiffness = 1;
  static BareSpring read(const ContactTable& t) { return {t.required("stiffness", 0, 1e9, true)}; }
  [[nodiscard]] double shortest_time(const PairScale& p, double) const {
    return 3 * std::sqrt(p.m_eff / stiffness);
  }
  [[nodiscard]] double largest_force(double overlap) const { return stiffness * overlap; }
  [[nodiscard]] bool is_elastic() const { return true; }
  [[nodiscard]] double impact_overlap(const PairScale& p, double speed) const {
    return speed * std::sqrt(p.m_eff / stiffness);
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale&) const { return {stiffness}; }
  template <class V>
  static V force(const V* c, V overlap, V, V*) {
    return c[0] * overlap;
  }
};
static_assert(NormalLaw<BareSpring>);
static_assert(!InLammps<BareSpring>);

/// A law that derives from one that LAMMPS has, and changes its force.
struct TwiceTheSpring : LinearSpringDashpot {
  static constexpr std::string_view kWord = "twice";
};
static_assert(!InLammps<TwiceTheSpring>);

static_assert(InLammps<LinearSpringDashpot> && InLammps<NoTensionSpringDashpot> && InLammps<NoTangential> &&
              InLammps<DashpotSlider> && InLammps<SpringSlider> && InLammps<NoRolling>);
static_assert(!InLammps<CohesiveSpringDashpot> && !InLammps<HertzViscoelastic> &&
              !InLammps<VelocityDependentRestitution> && !InLammps<SpringLimitedSlider> &&
              !InLammps<ForceClippedSlider> && !InLammps<MindlinSlider> && !InLammps<RollingSpring>);

// An undamped impact compresses the spring until k delta^2 = m_eff v^2.
TEST(NormalLaws, OverlapOfAnElasticImpactHoldsItsEnergy) {
  const PairScale pair = equal_beads(0.5, 1, 0.5);
  const double speed = 3;
  for (const double k : {1e4, 1e6}) {
    const double linear = LinearSpringDashpot{k, {}}.impact_overlap(pair, speed);
    const double falling = VelocityDependentRestitution{k, 0.7, 1}.impact_overlap(pair, speed);
    EXPECT_NEAR(k * linear * linear, 0.5 * speed * speed, 1e-9 * speed * speed);
    EXPECT_EQ(linear, falling);
  }
}

TEST(NormalLaws, AreElasticWithoutDamping) {
  for (const bool damped : {false, true}) {
    EXPECT_NE((LinearSpringDashpot{1e6, {damped ? 100.0 : 0.0, 0, 0}}.is_elastic()), damped);
    EXPECT_NE((NoTensionSpringDashpot{{1e6, {0, damped ? 1.0 : 0.0, 0}}}.is_elastic()), damped);
    EXPECT_NE((CohesiveSpringDashpot{{1e6, {0, 0, damped ? 1.0 : 0.0}}, 1}.is_elastic()), damped);
    EXPECT_NE((HertzViscoelastic{1e7, 0.3, damped ? 1e-3 : 0.0}.is_elastic()), damped);
    EXPECT_NE((VelocityDependentRestitution{1e6, damped ? 0.9 : 1.0, 1}.is_elastic()), damped);
  }
}

}  // namespace
}  // namespace twincell::sim::laws_test
