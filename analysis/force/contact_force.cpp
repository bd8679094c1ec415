#include "analysis/force/contact_force.hpp"

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
      : stored_(context.info.columns.contact_forces), density_(kForceRange, kForceWidth) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
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
    const std::string which = "contacts between beads; mean over frames with contacts";
    std::vector<Result> all = {mean_of(normal_,
                                       {.name = "contact_force",
                                        .unit = "m g",
                                        .n_of = "frames",
                                        .convention = "normal forces; " + which,
                                        .source = kSource},
                                       none)};
    if (friction_.n() == 0) {
      all.push_back(absent_result("tangential_to_normal", none, kSource));
    } else {
      Result r{.name = "tangential_to_normal",
               .values = {friction_.mean()},
               .unit = "1",
               .n = friction_.n(),
               .n_of = "frames",
               .convention = "mean tangential over mean normal force; " + which,
               .source = kSource};
      r.interval = friction_.interval(r.n_of);
      if (!r.interval) r.no_interval = friction_.why_no_interval(r.n_of);
      all.push_back(std::move(r));
    }
    for (Result& r : density_.results("contact_force", "normal force", which, kSource, none))
      all.push_back(std::move(r));
    all.push_back(
        mean_of(contact_number_,
                {.name = "mechanical_contact_number",
                 .unit = "1",
                 .n_of = "frames",
                 .convention = "beads with two contacts or more; contacts with walls count; mean over "
                               "frames that have such beads",
                 .source = kThornton},
                stored_ ? "no frame has a bead with two contacts" : none));
    return all;
  }

 private:
  void add_contact_number(const std::vector<std::size_t>& contacts) {
    double sum = 0, bearing = 0;
    for (const std::size_t n : contacts)
      if (n > 1) {
        sum += static_cast<double>(n);
        ++bearing;
      }
    if (bearing > 0) contact_number_.add(sum / bearing);
  }

  bool stored_;
  SeriesAverage normal_, contact_number_;
  RatioAverage friction_;
  RatioDensity density_;
};

}  // namespace

constinit const ObservableEntry contact_force_observable = {kResults, &make_observable<ContactForces>};

}  // namespace twincell::analysis
