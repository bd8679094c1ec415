#include "analysis/order/contact_number.hpp"

#include <algorithm>
#include <cmath>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "contact_number", .range = Range::not_negative, .main = true},
                                    {.name = "contact_number_inside", .range = Range::not_negative}};
const char* const kSource = "Thornton 2000";

class ContactNumber : public Observable {
 public:
  explicit ContactNumber(const AnalysisContext& context) : info_(context.info) {
    for (const double r : info_.radius) largest_ = std::max(largest_, r);
    if (info_.radius.empty()) largest_ = kUsualRadius;
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const bool planar = info_.box.dimension == 2;
    // Rounding must not decide whether beads at the very distance touch.
    constexpr double kRounding = 1e-9;
    const double reach = kContactReach * (1 + kRounding);
    const Neighbours near = find_neighbours(frame, info_.box, 2 * largest_ * reach);
    double contacts = 0, beads = 0, contacts_inside = 0, inside = 0;
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !frame.position[i].allFinite()) continue;
      double touching = 0;
      near.for_each(i, [&](std::size_t j, const Vec3& bond) {
        if (bond.norm() <= reach * (radius_of(info_.radius, i) + radius_of(info_.radius, j))) ++touching;
      });
      ++beads;
      contacts += touching;
      if (!planar || view.cells().enclosed[i] == 0) continue;
      ++inside;
      contacts_inside += touching;
    }
    if (beads > 0) all_.add(contacts / beads);
    if (inside > 0) inside_.add(contacts_inside / inside);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const auto mean = [](const char* name, const SeriesAverage& series, const std::string& which,
                         const std::string& none) {
      return mean_of(
          series,
          {.name = name,
           .unit = "1",
           .n_of = "frames",
           .convention = which + "; centres within 1.05 times the sum of the radii; walls do not count",
           .source = kSource},
          none);
    };
    return {mean("contact_number", all_, "all beads", "no frame has a bead"),
            mean("contact_number_inside", inside_, "beads with an enclosed Voronoi cell",
                 info_.box.dimension == 2 ? "no bead is enclosed by its neighbours"
                                          : "the cell is three-dimensional: cells are those of a plane")};
  }

 private:
  const TrajectoryInfo& info_;
  double largest_ = 0;  ///< radius, sigma
  SeriesAverage all_, inside_;
};

}  // namespace

constinit const ObservableEntry contact_number_observable = {
    kResults, &make_observable<ContactNumber>, {"cell_radius"}};

}  // namespace twincell::analysis
