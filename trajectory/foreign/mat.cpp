// MATLAB's MAT-file, level 5 (readable by MATLAB, Octave and SciPy): one matrix per quantity, a row per bead
// and a column per frame. Source: MathWorks, "MAT-File Format", version 5.

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"

namespace twincell {

namespace {

constexpr const char* kHeader = "MATLAB 5.0 MAT-file, written by twincell";
constexpr std::size_t kMaxBytes = std::size_t{1} << 31;  // of a variable at level 5

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

class MatWriter final : public ForeignWriter {
 public:
  MatWriter(const std::filesystem::path& part, const WriteOptions& options)
      : part_(part), has_(options.columns), options_(options) {}

  void append(const ForeignFrame& s) override {
    for (const ForeignBead& bead : s.beads)
      n_beads_ = std::max(n_beads_, static_cast<std::size_t>(bead.id) + 1);
    if (8 * n_beads_ * (n_frames_ + 1) >= kMaxBytes)
      throw RunError(
          fmt::format("{}: a matrix of {} beads and {} frames is larger than the 2 GB of a MAT-file; "
                      "export fewer frames, or to another format.",
                      part_.string(), n_beads_, n_frames_ + 1));
    frame("time", s.time.value_or(kAbsent));
    frame("step", static_cast<double>(s.step));
    if (has_.phase) {
      frame("phase", s.phase ? static_cast<double>(*s.phase) : kAbsent);
      frame("cycle", s.cycle ? static_cast<double>(*s.cycle) : kAbsent);
    }
    frame("plate_height", s.plate_height.value_or(kAbsent));
    const int axes = options_.dimension;
    for (std::size_t k = 0; k < s.beads.size(); ++k) {
      const ForeignBead& b = s.beads[k];
      const auto id = static_cast<std::size_t>(b.id);
      vector("", axes, id, b.position);
      if (has_.velocity[0]) vector("v", axes, id, b.velocity);
      if (has_.spin[2]) vector("omega_", 3, id, b.spin);
      if (has_.uncertainty) vector("sigma_", axes, id, b.uncertainty);
      if (has_.radius) fixed("radius", id, b.radius);
      if (has_.mass) fixed("bead_mass", id, b.mass);
      if (has_.type) fixed("tracer", id, b.type == 2 ? 1 : 0);
      for (std::size_t n = 0; n < has_.numbers.size(); ++n)
        moving_[has_.numbers[n]].push_back({n_frames_, id, s.numbers[n][k]});
    }
    ++n_frames_;
  }

  void finish() override {
    for (auto& [name, values] : of_bead_) values.resize(n_beads_, kAbsent);
    {
      const File file(Mat_CreateVer(part_.c_str(), kHeader, MAT_FT_MAT5), &Mat_Close);
      if (!file) fail();
      each_variable([&](matvar_t* v) {
        if (Mat_VarWrite(file.get(), v, MAT_COMPRESSION_ZLIB) != 0) fail();
      });
    }
    // The library does not report a full disk: read the file back.
    const File file(Mat_Open(part_.c_str(), MAT_ACC_RDONLY), &Mat_Close);
    if (!file) fail();
    each_variable([&](matvar_t* v) {
      const Variable stored(Mat_VarReadNext(file.get()), &Mat_VarFree);
      if (!stored || std::string(stored->name) != v->name || !stored->data ||
          (v->class_type == MAT_C_DOUBLE &&
           (stored->nbytes != v->nbytes || std::memcmp(stored->data, v->data, v->nbytes) != 0)))
        fail();
    });
  }

 private:
  struct Cell {
    std::size_t frame, bead;
    double value;
  };

  void frame(const char* name, double value) { of_frame_[name].push_back(value); }
  void vector(const std::string& name, int axes, std::size_t id, const Vec3& v) {
    for (int k = 0; k < axes; ++k)
      moving_[name + "xyz"[static_cast<std::size_t>(k)]].push_back({n_frames_, id, v[k]});
  }
  void fixed(const char* name, std::size_t id, double value) {
    std::vector<double>& values = of_bead_[name];
    if (values.size() <= id) values.resize(id + 1, kAbsent);
    values[id] = value;
  }
  [[nodiscard]] std::vector<double> matrix(const std::vector<Cell>& cells) const {
    std::vector<double> values(n_beads_ * n_frames_, kAbsent);
    for (const Cell& c : cells) values[c.frame * n_beads_ + c.bead] = c.value;
    return values;
  }

  using File = std::unique_ptr<mat_t, int (*)(mat_t*)>;
  using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

  /// Makes one variable after the other and hands it to `use`.
  template <class Use>
  void each_variable(Use use) const {
    const auto numbers = [&](const std::string& name, std::vector<double> values, std::size_t rows,
                             std::size_t columns) {
      std::size_t shape[2] = {rows, columns};
      hand(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape, values.data(), 0), use);
    };
    const auto words = [&](const char* name, std::string text) {
      std::size_t shape[2] = {1, text.size()};
      hand(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, shape, text.data(), 0), use);
    };
    for (const auto& [name, values] : of_frame_) numbers(name, values, 1, n_frames_);
    for (const auto& [name, cells] : moving_) numbers(name, matrix(cells), n_beads_, n_frames_);
    for (const auto& [name, values] : of_bead_) numbers(name, values, n_beads_, 1);
    words("length_unit", options_.length_unit);
    words("time_unit", options_.time_unit);
  }
  template <class Use>
  void hand(matvar_t* made, Use use) const {
    const Variable variable(made, &Mat_VarFree);
    if (!variable) fail();
    use(variable.get());
  }
  [[noreturn]] void fail() const {
    throw RunError(part_.string() + ": cannot be written in full; is the disk full?");
  }

  std::filesystem::path part_;
  ForeignColumns has_;
  WriteOptions options_;
  std::size_t n_beads_ = 0, n_frames_ = 0;
  std::map<std::string, std::vector<double>> of_frame_, of_bead_;
  std::map<std::string, std::vector<Cell>> moving_;
};

}  // namespace

extern const ForeignFormat mat_format;
const ForeignFormat mat_format = {
    .word = "mat",
    .extensions = ".mat",
    .help = "MAT-file, a matrix of beads and frames per quantity: MATLAB, Octave, SciPy",
    .open = nullptr,
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<MatWriter>(part, options); },
    .numbers = true,
    .mark = kHeader};

}  // namespace twincell
