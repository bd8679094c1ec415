#include "analysis/force/stress_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/force/frames_of_landings.hpp"
#include "trajectory/branch_vector.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"stress_field"}, {"stress_field_x"}, {"stress_field_z"}};
const char* const kSource = "Goldhirsch 2010";
constexpr double kReach = 4 * kCoarseWidth;  // sigma, beyond which the Gaussian is below 4e-4 of its maximum
constexpr double kMaxPoints = 1e6;           // a damaged file may have a bead at 1e7 sigma
constexpr std::size_t kMaxColumns = 10'000;

class StressField : public Observable {
 public:
  explicit StressField(const AnalysisContext& context) : info_(context.info) {
    width_ = info_.box.size().x();
    columns_ =
        std::min(kMaxColumns,
                 static_cast<std::size_t>(std::max(1.0, std::round(width_ / context.options.field_cell))));
    cell_ = width_ / static_cast<double>(columns_);
    depth_ = info_.box.dimension == 2 ? 1 : info_.box.size().y();
    row_height_ = cell_;
    if (!info_.box.periodic(Axis::z)) return;
    period_ = info_.box.size().z();
    rows_of_period_ =
        std::min(kMaxColumns,
                 static_cast<std::size_t>(std::max(1.0, std::round(period_ / context.options.field_cell))));
    row_height_ = period_ / static_cast<double>(rows_of_period_);
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (!info_.columns.contact_forces || !(cell_ > 0 && depth_ > 0)) return;
    const double plate = plate_height(info_, frame).value_or(info_.box.lower.z());
    for (const ContactForce& c : frame.contact_forces) {
      const Vec3 end = frame.position[static_cast<std::size_t>(c.i)] - plate * Vec3::UnitZ();
      if (const Vec3 branch = branch_vector(c, info_);
          end.allFinite() && (rows_of_period_ > 0 ||
                              std::abs(end.z()) / row_height_ * static_cast<double>(columns_) < kMaxPoints))
        add_contact(end, branch, c.force());
    }
    ++frames_;
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string none = !info_.columns.contact_forces
                                 ? "the trajectory stores no contact forces (simulate --contacts)"
                                 : "no frame has a contact";
    if (rows_ == 0) {
      std::vector<Result> absent;
      for (const NamedResult& r : kResults)
        absent.push_back(absent_result(std::string(r.name), none, kSource));
      return absent;
    }
    Result field{
        .name = "stress_field",
        .shape = {rows_, columns_, 2, 2},
        .unit = info_.box.dimension == 2 ? "m g/sigma" : "m g/sigma^2",
        .n = frames_,
        .n_of = "frames",
        .convention = fmt::format("Gaussian of width {:g} sigma at points {:.4g} sigma apart; smaller "
                                  "within two widths of a wall and of the surface; mean over frames{}",
                                  kCoarseWidth, cell_, aliasing_note(info_)),
        .source = kSource};
    const double per = 1 / (static_cast<double>(frames_) * depth_);
    for (std::size_t k = 0; k < rows_ * columns_; ++k)
      for (const double sum : sums_[k]) field.values.push_back(sum * per);
    std::vector<double> x, z;
    for (std::size_t c = 0; c < columns_; ++c) x.push_back(x_of(c));
    for (std::size_t r = 0; r < rows_; ++r) z.push_back(z_of(r));
    return {
        field,
        array_of(x, {.name = "stress_field_x", .unit = "sigma", .n_of = "columns", .source = kSource}, none),
        array_of(z, {.name = "stress_field_z", .unit = "sigma", .n_of = "rows", .source = kSource}, none)};
  }

 private:
  [[nodiscard]] double x_of(std::size_t column) const {
    return info_.box.lower.x() + (static_cast<double>(column) + 0.5) * cell_;
  }
  [[nodiscard]] double z_of(std::size_t row) const { return (static_cast<double>(row) + 0.5) * row_height_; }

  /// Adds f_a l_b times the integral of the Gaussian along the branch, which ends at `end`.
  void add_contact(const Vec3& end, const Vec3& branch, const Vec3& force) {
    const double length = std::hypot(branch.x(), branch.z());
    // From the centre of i along the branch. Without a length in the plane the Gaussian is that of a point.
    const double ux = length > 0 ? -branch.x() / length : 1, uz = length > 0 ? -branch.z() / length : 0;
    const double low = std::min(end.z(), end.z() - branch.z()),
                 high = std::max(end.z(), end.z() - branch.z());
    const auto row_at = [&](double z) {
      return static_cast<std::size_t>(std::max(0.0, std::floor(z / row_height_)));
    };
    const bool repeats = rows_of_period_ > 0;
    const std::size_t first = repeats ? 0 : row_at(low - kReach),
                      last = repeats ? rows_of_period_ - 1 : row_at(high + kReach);
    rows_ = std::max(rows_, last + 1);
    sums_.resize(rows_ * columns_, {0, 0, 0, 0});
    const bool periodic = info_.box.periodic(Axis::x);
    for (std::size_t row = first; row <= last; ++row)
      for (std::size_t column = 0; column < columns_; ++column) {
        double dx = x_of(column) - end.x();
        if (periodic) dx = std::remainder(dx + branch.x() / 2, width_) - branch.x() / 2;
        if (std::abs(dx + branch.x() / 2) > kReach + length / 2) continue;
        double dz = z_of(row) - end.z();
        if (repeats) dz = std::remainder(dz + branch.z() / 2, period_) - branch.z() / 2;
        const double along = dx * ux + dz * uz;
        const double across = dx * dx + dz * dz - along * along;
        const double weight = std::exp(-across / (2 * kCoarseWidth * kCoarseWidth)) /
                              (std::sqrt(2 * std::numbers::pi) * kCoarseWidth) * mean_along(along, length);
        std::array<double, 4>& sum = sums_[row * columns_ + column];
        sum[0] += weight * force.x() * branch.x(), sum[1] += weight * force.x() * branch.z();
        sum[2] += weight * force.z() * branch.x(), sum[3] += weight * force.z() * branch.z();
      }
  }

  /// Mean over the length of the branch of the Gaussian in one dimension, at `along` from its end.
  static double mean_along(double along, double length) {
    constexpr double kMinLength_sigma = 1e-6;
    const double scale = 1 / (std::numbers::sqrt2 * kCoarseWidth);
    if (length < kMinLength_sigma)
      return std::exp(-along * along * scale * scale) / (std::sqrt(2 * std::numbers::pi) * kCoarseWidth);
    return (std::erf(along * scale) - std::erf((along - length) * scale)) / (2 * length);
  }

  const TrajectoryInfo& info_;
  std::size_t columns_ = 1, rows_ = 0, frames_ = 0;
  std::size_t rows_of_period_ = 0;  // 0 unless the cell is periodic along z
  double width_ = 1, cell_ = 1, row_height_ = 1, depth_ = 1, period_ = 0;
  std::vector<std::array<double, 4>> sums_;  ///< [rows x columns] xx, xz, zx, zz
};

}  // namespace

constinit const ObservableEntry stress_field_observable = {
    kResults, &make_observable<StressField>, {"field_cell"}};

}  // namespace twincell::analysis
