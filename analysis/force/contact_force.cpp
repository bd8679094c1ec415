#include "analysis/force/contact_force.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/force/frames_of_landings.hpp"
#include "analysis/observable/cycle_average.hpp"
#include "analysis/observable/ratio_density.hpp"
#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "contact_force", .range = Range::not_negative},
                                    {.name = "tangential_to_normal", .range = Range::not_negative},
                                    {"contact_force_density"},
                                    {"contact_force_density_low"},
                                    {"contact_force_density_high"},
                                    {"contact_force_ratio"},
                                    {.name = "mechanical_contact_number", .range = Range::not_negative}};
const char* const kSource = "Mueth, Jaeger & Nagel 1998";
const char* const kThornton = "Thornton 2000";

class ContactForces : public Observable {
 public:
  explicit ContactForces(const AnalysisContext& context)
      : info_(context.info),
        stored_(info_.columns.contact_forces),
        density_(kForceRange, kForceWidth),
        in_contact_(info_.phases_per_cycle),
        normal_over_time_(info_.phases_per_cycle),
        tangential_over_time_(info_.phases_per_cycle) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    add_time_mean(frame);
    std::vector<std::size_t> contacts(frame.position.size(), 0);
    double normal = 0, tangential = 0, pairs = 0;
    for (const ContactForce& c : frame.contact_forces) {
      ++contacts[static_cast<std::size_t>(c.i)];
      if (c.j < 0) continue;
      ++contacts[static_cast<std::size_t>(c.j)];
      ++pairs;
      normal += c.normal_force;
      tangential += c.tangential_force.norm();
    }
    add_contact_number(contacts);
    if (!(pairs > 0)) return;
    normal_.add(normal / pairs);
    if (!(normal > 0)) return;  // a ratio to a mean attraction has no meaning
    friction_.add(tangential / pairs, normal / pairs);
    std::vector<double> forces;
    for (const ContactForce& c : frame.contact_forces)
      if (c.j >= 0) forces.push_back(c.normal_force);
    density_.add(forces, normal / pairs);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string none = stored_ ? "no frame has a contact between beads"
                                     : "the trajectory stores no contact forces (simulate --contacts)";
    const bool over_time = force_.n() > 0;
    const std::string of_frames = "contacts between beads; mean over frames with contacts",
                      which = over_time ? fmt::format(
                                              "contacts between beads; mean over the time with contacts, {} "
                                              "samples per cycle",
                                              info_.samples_per_cycle / 2)
                                        : of_frames;
    const auto ratio = [&](const char* name, const RatioAverage& average, const std::string& unit,
                           const std::string& what) {
      if (average.n() == 0 || !std::isfinite(average.mean())) return absent_result(name, none, kSource);
      Result r{.name = name,
               .values = {average.mean()},
               .unit = unit,
               .n = average.n(),
               .n_of = over_time ? "cycles" : "frames",
               .convention = what + which,
               .source = kSource};
      r.interval = average.interval(r.n_of);
      if (!r.interval) r.no_interval = average.why_no_interval(r.n_of);
      return over_time ? r : over_frames(std::move(r), info_);
    };
    std::vector<Result> all;
    all.push_back(over_time ? ratio("contact_force", force_, "m g", "normal forces; ")
                            : over_frames(mean_of(normal_,
                                                  {.name = "contact_force",
                                                   .unit = "m g",
                                                   .n_of = "frames",
                                                   .convention = "normal forces; " + which,
                                                   .source = kSource},
                                                  none),
                                          info_));
    all.push_back(ratio("tangential_to_normal", over_time ? friction_over_time_ : friction_, "1",
                        "mean tangential over mean normal force; "));
    for (Result& r :
         density_.results("contact_force", "normal force", of_frames + aliasing_note(info_), kSource, none))
      all.push_back(std::move(r));
    all.push_back(over_frames(
        mean_of(contact_number_,
                {.name = "mechanical_contact_number",
                 .unit = "1",
                 .n_of = "frames",
                 .convention = "beads with two contacts or more; contacts with walls count; mean over "
                               "frames that have such beads",
                 .source = kThornton},
                stored_ ? "no frame has a bead with two contacts" : none),
        info_));
    return all;
  }

 private:
  void add_time_mean(const Frame& frame) {
    const BedForces& mean = frame.force_mean;
    if (!mean.known()) return;
    const auto time = in_contact_.add(frame, mean.in_contact),
               normal = normal_over_time_.add(frame, mean.normal_force),
               tangential = tangential_over_time_.add(frame, mean.tangential_force);
    if (!time || !normal || !tangential || !(*time > 0)) return;
    force_.add(*normal, *time);
    if (*normal > 0) friction_over_time_.add(*tangential, *normal);
  }

  void add_contact_number(const std::vector<std::size_t>& contacts) {
    double sum = 0, bearing = 0;
    for (const std::size_t n : contacts)
      if (n > 1) {
        sum += static_cast<double>(n);
        ++bearing;
      }
    if (bearing > 0) contact_number_.add(sum / bearing);
  }

  const TrajectoryInfo& info_;
  bool stored_;
  SeriesAverage normal_, contact_number_;
  RatioAverage friction_;
  RatioDensity density_;
  CycleAverage in_contact_, normal_over_time_, tangential_over_time_;
  RatioAverage force_, friction_over_time_;  ///< from cycles of means over time
};

}  // namespace

constinit const ObservableEntry contact_force_observable = {kResults, &make_observable<ContactForces>};

}  // namespace twincell::analysis
