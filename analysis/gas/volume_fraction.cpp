#include "analysis/gas/volume_fraction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "trajectory/centre_of_mass.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "phi_top", .range = Range::share, .filling = true},
                                    {.name = "phi_cm", .range = Range::share, .main = true, .filling = true}};

const char* const kSource = "Bhateja, Sharma & Singh 2016, sec. IV";

class VolumeFraction : public Observable {
 public:
  explicit VolumeFraction(const AnalysisContext& context) : info_(context.info) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const bool flat = info_.box.dimension == 2;
    double volume = 0, top = 0;
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !std::isfinite(frame.position[i].z())) continue;
      const double r = radius_of(info_.radius, i);
      volume += flat ? std::numbers::pi * r * r : 4 * std::numbers::pi / 3 * r * r * r;
      top = std::max(top, frame.position[i].z() + r);
    }
    const Vec3 size = info_.box.size();
    const double per_height = volume / (size.x() * (flat ? 1 : size.y()));
    const double twice_centre = 2 * centre_of_mass_height(frame, info_.mass);
    if (!(per_height > 0)) return;
    add_to(by_top_, per_height, top);
    add_to(by_centre_, per_height, twice_centre);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const auto result = [&](const char* name, const Fraction& fraction, const char* up_to) {
      if (info_.box.periodic(Axis::z))
        return absent_result(name, "the cell is periodic along z: the bed has no top", kSource);
      if (fraction.sunk)
        return absent_result(
            name,
            "in some frame the beads need more volume than there is between the plate's mean height "
            "and the top of the bed: the bed moves with the plate",
            kSource);
      const SeriesAverage& mean = fraction.mean;
      Result r =
          mean_of(mean,
                  {.name = name,
                   .unit = "1",
                   .n_of = "frames",
                   .convention = std::string("beads over the cell up to ") + up_to + ", mean over frames",
                   .source = kSource},
                  "no frame holds beads above the plate");
      if (r.present() && !r.interval) r.no_interval = mean.why_no_interval(r.n_of);
      return r;
    };
    return {result("phi_top", by_top_, "the top of the highest bead"),
            result("phi_cm", by_centre_, "twice the height of the centre of mass")};
  }

 private:
  struct Fraction {
    SeriesAverage mean;
    bool sunk = false;  ///< in some frame the beads need more volume than there is
  };
  static void add_to(Fraction& fraction, double per_height, double height) {
    if (height < per_height)
      fraction.sunk = true;
    else
      fraction.mean.add(per_height / height);
  }

  const TrajectoryInfo& info_;
  Fraction by_top_, by_centre_;
};

}  // namespace

constinit const ObservableEntry volume_fraction_observable = {kResults, &make_observable<VolumeFraction>};

}  // namespace twincell::analysis
