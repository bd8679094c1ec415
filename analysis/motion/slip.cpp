#include "analysis/motion/slip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/median.hpp"

namespace twincell::analysis {
namespace {

/// Definition 1 took the 99th percentile of all heights for the surface, which beads thrown by strong drives
/// raise by several sigma.
constexpr int kDefinition = 2;

constexpr NamedResult slip_result(std::string_view name, Pooling pooling) {
  return {.name = name,
          .pooling = pooling,
          .range = pooling == Pooling::sum ? Range::not_negative : Range::share,
          .may_repeat = true,
          .main = name == "p_s",
          .definition = kDefinition};
}

constexpr NamedResult kResults[] = {
    slip_result("p_s", Pooling::probability),     slip_result("slips", Pooling::sum),
    slip_result("p_s_j", Pooling::mean),          slip_result("slip_directions", Pooling::sum),
    slip_result("slip_oblique", Pooling::mean),   slip_result("slip_vertical", Pooling::mean),
    slip_result("slip_horizontal", Pooling::mean)};

constexpr std::size_t kDirections = 36;
constexpr double kColumn = 2;   ///< width of the columns in which the surface is sought, sigma
constexpr double kWithin = 15;  ///< maximum angle to a nominal direction, degrees

/// Number of slipped bonds in one period, by direction.
struct Moved {
  double all = 0, oblique = 0, vertical = 0, horizontal = 0;
};

/// Direction of a displacement in the (x, z) plane as a line, degrees in [0, 180).
double direction_of(const Vec3& d) {
  const double degrees = std::atan2(d.z(), d.x()) * 180 / std::numbers::pi;
  const double line = degrees < 0 ? degrees + 180 : degrees;
  return line >= 180 ? 0 : line;
}

/// Angle between two lines, degrees in [0, 90].
double between_lines(double a, double b) {
  const double d = std::abs(a - b);
  return std::min(d, 180 - d);
}

/// Height of the free surface of the bed: median over vertical columns of the height of the highest bead that
/// has `kSurfaceNeighbours`. Thrown beads have few neighbours, so they do not raise it, however many they
/// are. Columns without such a bead do not count; absent if no column has one.
std::optional<double> free_surface(const Frame& frame, const Neighbours& neighbours) {
  std::map<std::pair<long, long>, double> tops;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    const Vec3& r = frame.position[i];
    if (!frame.present(i) || !r.allFinite() || neighbours.count(i) < kSurfaceNeighbours) continue;
    const std::pair column{std::lround(std::floor(r.x() / kColumn)),
                           std::lround(std::floor(r.y() / kColumn))};
    const auto [top, is_new] = tops.try_emplace(column, r.z());
    if (!is_new) top->second = std::max(top->second, r.z());
  }
  if (tops.empty()) return std::nullopt;
  std::vector<double> z;
  for (const auto& [column, top] : tops) z.push_back(top);
  return upper_median(std::move(z));
}

class Slip : public Observable {
 public:
  explicit Slip(const AnalysisContext& context) : context_(context) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.phase != 0 || frame.cycle < 0) return;
    if (have_start_ && frame.cycle == start_.cycle + 1) close_period(frame);
    start_ = frame;
    neighbours_ = view.neighbours();
    have_start_ = true;
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string source = "Fortini & Huang 2015, sec. V";
    const std::string reason = why_none();
    if (!reason.empty()) {
      std::vector<Result> none;
      for (const NamedResult& result : kResults)
        none.push_back(absent_result(std::string(result.name), reason, source));
      return none;
    }
    std::vector<Result> all;
    add_probability(all, source);
    add_directions(all, source);
    return all;
  }

 private:
  [[nodiscard]] Vec3 moved(const Frame& end, std::size_t i) const {
    return context_.info.box.nearest_image(end.position[i] - start_.position[i]);
  }
  [[nodiscard]] bool seen(const Frame& end, std::size_t i) const {
    return start_.present(i) && end.present(i) && start_.position[i].allFinite() &&
           end.position[i].allFinite();
  }

  void close_period(const Frame& end) {
    ++periods_;
    const std::optional<double> surface = free_surface(start_, neighbours_);
    if (!surface) return;
    const double deepest = *surface - kSlipDepth;
    const std::size_t n = start_.position.size();
    std::size_t eligible = 0, slipping = 0;
    slips_now_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (!seen(end, i) || start_.position[i].z() > deepest) continue;
      std::size_t known = 0, broken = 0;
      const Vec3 own = moved(end, i);
      neighbours_.for_each(i, [&](std::size_t j, const Vec3&) {
        if (!seen(end, j)) return;
        ++known;
        broken += (moved(end, j) - own).norm() > kSlipDistance ? 1 : 0;
      });
      if (known < kSlipBonds) {
        ++lost_;
        continue;
      }
      ++eligible;
      if (broken >= kSlipBonds) {
        ++slipping;
        slips_now_[i] = 1;
      }
    }
    if (eligible == 0) return;
    slips_ += slipping;
    trials_ += eligible;
    const double fraction = static_cast<double>(slipping) / static_cast<double>(eligible);
    fraction_.add(fraction);
    p_s_j_.push_back(fraction);
    if (slipping > 0) count_directions(end);
  }

  /// Counts the slipped bonds by direction. A bond counts once even if both of its beads slip.
  void count_directions(const Frame& end) {
    Moved now;
    for (std::size_t i = 0; i < slips_now_.size(); ++i) {
      if (slips_now_[i] == 0) continue;
      const Vec3 own = moved(end, i);
      neighbours_.for_each(i, [&](std::size_t j, const Vec3&) {
        if (!seen(end, j) || (slips_now_[j] != 0 && j < i)) return;
        const Vec3 d = moved(end, j) - own;
        if (!(d.norm() > kSlipDistance)) return;
        const double line = direction_of(d);
        directions_[static_cast<std::size_t>(line * kDirections / 180 + 0.5) % kDirections] += 1;
        now.all += 1;
        now.oblique += std::min(between_lines(line, 60), between_lines(line, 120)) <= kWithin ? 1 : 0;
        now.vertical += between_lines(line, 90) < kWithin ? 1 : 0;
        now.horizontal += between_lines(line, 0) <= kWithin ? 1 : 0;
      });
    }
    moved_.push_back(now);
  }

  [[nodiscard]] std::string why_none() const {
    if (!context_.info.columns.phase) return "the frames are not locked to the drive's phase";
    if (context_.info.box.periodic(Axis::z))
      return "the cell is periodic along z: the bed has no free surface below which slips count";
    if (periods_ == 0)
      return "slip is counted between the beginnings of consecutive cycles, and the trajectory does not "
             "contain two of them";
    if (trials_ == 0)
      return fmt::format(
          "no eligible bead: no bead is {:g} sigma below the free surface with two neighbours in {} periods",
          kSlipDepth, periods_);
    return "";
  }

  /// Ratio of the observed variance of p_s to that of independent trials, at least 1, with its description.
  /// Beads that slip together are not independent; the scatter from period to period measures the effect.
  [[nodiscard]] std::pair<double, std::string> design_effect(const Interval& interval) const {
    const double p = fraction_.mean();
    const double error = (interval.high - interval.low) / 2 / student_t_95(1e9);
    const double variance = error * error;
    const double independent = p * (1 - p) / static_cast<double>(trials_);
    const double effect = independent > 0 ? std::max(1.0, variance / independent) : 1;
    return {effect,
            fmt::format("counts divided by {:.3g}, the scatter between periods over that of independent "
                        "beads, correlation time {:.3g} periods",
                        effect, fraction_.correlation_time())};
  }

  void add_probability(std::vector<Result>& all, const std::string& source) const {
    const std::string rule = fmt::format(
        "at least {} neighbours moved relative to the bead by more than {:g} sigma in one period, neighbours "
        "at the start of the period; beads {:g} sigma or more below the surface of the bed (median over "
        "columns "
        "{:g} sigma wide of the highest bead with {} neighbours); {}",
        kSlipBonds, kSlipDistance, kSlipDepth, kColumn, kSurfaceNeighbours, neighbour_rule_text(context_));
    Result p_s{
        .name = "p_s", .values = {fraction_.mean()}, .unit = "1", .n = trials_, .n_of = "bead-periods"};
    const auto trials = static_cast<double>(trials_);
    if (slips_ == 0) {
      p_s.interval = binomial_interval(0, trials, "bead-periods");
    } else if (const auto interval = fraction_.interval("periods"); !interval && fraction_.has_no_scatter()) {
      p_s.interval = binomial_interval(fraction_.mean() * trials, trials, "bead-periods");
      p_s.interval->method += "; " + fraction_.why_no_interval("periods");
    } else if (!interval) {
      p_s.no_interval = fraction_.why_no_interval("periods");
    } else {
      const auto [effect, how] = design_effect(*interval);
      const double counts = fraction_.mean() * trials;
      p_s.interval = effect > 1 && counts < trials
                         ? wilson_interval(counts / effect, trials / effect, "effective bead-periods")
                         : binomial_interval(counts, trials, "bead-periods");
      p_s.interval->method += "; " + how;
    }
    p_s.convention = fmt::format("mean over {} periods of slipping/eligible; {} slips in {} trials; {}",
                                 p_s_j_.size(), slips_, trials_, rule);
    if (p_s_j_.size() < periods_)
      p_s.convention += fmt::format("; {} periods without an eligible bead", periods_ - p_s_j_.size());
    if (lost_ > 0)
      p_s.convention += fmt::format("; {} deep bead-periods with fewer than two neighbours left out", lost_);
    p_s.source = source;

    Result slips{.name = "slips",
                 .values = {static_cast<double>(slips_)},
                 .unit = "1",
                 .n = trials_,
                 .n_of = "bead-periods"};
    slips.convention = rule;
    slips.no_interval = "a count, exact; its probability is p_s";
    slips.source = source;

    Result each{.name = "p_s_j",
                .values = p_s_j_,
                .shape = {p_s_j_.size()},
                .unit = "1",
                .n = p_s_j_.size(),
                .n_of = "periods"};
    each.convention = "slipping/eligible in each period, in order; " + rule;
    each.no_interval = "single periods; p_s has the interval of their mean";
    each.source = source;
    all.push_back(std::move(p_s));
    all.push_back(std::move(slips));
    all.push_back(std::move(each));
  }

  void add_directions(std::vector<Result>& all, const std::string& source) const {
    if (moved_.empty()) {
      for (const char* name : {"slip_directions", "slip_oblique", "slip_vertical", "slip_horizontal"})
        all.push_back(absent_result(name, fmt::format("no bead slipped in {} trials", trials_), source));
      return;
    }
    double bonds = 0;
    for (const Moved& m : moved_) bonds += m.all;
    Result histogram{.name = "slip_directions",
                     .values = {directions_.begin(), directions_.end()},
                     .shape = {kDirections},
                     .unit = "1",
                     .n = static_cast<std::size_t>(bonds),
                     .n_of = "bonds"};
    histogram.convention = fmt::format(
        "number of bonds of slipping beads by the direction in which they moved: about 0 (horizontal), "
        "{:g}, ... degrees, 90 is vertical",
        180.0 / kDirections);
    histogram.no_interval = "counts, exact";
    histogram.source = source;
    all.push_back(std::move(histogram));
    add_share(all, "slip_oblique", &Moved::oblique, "+-60 degrees; 1/3 without a preferred direction",
              source);
    add_share(all, "slip_vertical", &Moved::vertical, "90 degrees; 1/6 without a preferred direction",
              source);
    add_share(all, "slip_horizontal", &Moved::horizontal, "0 degrees; 1/6 without a preferred direction",
              source);
  }

  void add_share(std::vector<Result>& all, const std::string& name, double Moved::*kind,
                 const std::string& about, const std::string& source) const {
    std::vector<std::size_t> every(moved_.size());
    for (std::size_t p = 0; p < every.size(); ++p) every[p] = p;
    const auto share = [&](const std::vector<std::size_t>& periods) {
      double some = 0, bonds = 0;
      for (const std::size_t p : periods) {
        some += moved_[p].*kind;
        bonds += moved_[p].all;
      }
      return some / bonds;
    };
    Result r{.name = name, .values = {share(every)}, .unit = "1", .n = moved_.size(), .n_of = "periods"};
    r.interval = bootstrap_interval(moved_.size(), share, "periods with slips");
    if (!r.interval)
      r.no_interval = moved_.size() < 2 ? "slips in one period only" : "the same in every period with slips";
    r.convention =
        fmt::format("share of the moved bonds of slipping beads within {:g} degrees of {}", kWithin, about);
    r.source = source;
    all.push_back(std::move(r));
  }

  const AnalysisContext& context_;
  Frame start_;
  Neighbours neighbours_;
  bool have_start_ = false;
  std::size_t periods_ = 0;
  std::size_t lost_ = 0;
  std::size_t slips_ = 0;
  std::size_t trials_ = 0;
  std::vector<char> slips_now_;
  SeriesAverage fraction_;
  std::vector<double> p_s_j_;
  std::array<double, kDirections> directions_ = {};
  std::vector<Moved> moved_;
};

}  // namespace

constinit const ObservableEntry slip_observable = {kResults, &make_observable<Slip>, {"neighbours"}};

}  // namespace twincell::analysis
