#pragma once
/// \file
/// A frame in the units and axes of another program, and the interfaces that read and write such frames.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trajectory/box.hpp"

namespace twincell {

/// A bead of a ForeignFrame.
struct ForeignBead {
  std::int64_t id = 0;
  long line = 0;  ///< of the file that it was read from, from 1; 0: a binary file
  long type = 0;
  double radius = 0, mass = 0;
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  Vec3 uncertainty = Vec3::Zero();  ///< standard uncertainty of the position
};

/// A contact of a ForeignFrame: a line with its force.
struct ForeignContact {
  std::int64_t i = 0, j = 0;  ///< ids of the beads; j = -1 - w for wall w
  /// From the centre of i to that of j, across a period to its nearest image; to the point of contact at a
  /// wall.
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double overlap = 0;                    ///< in the unit of length
  double normal_force = 0;               ///< m g; negative: attraction
  Vec3 tangential_force = Vec3::Zero();  ///< on i, m g
};

/// A frame in the units and axes of another program. A two-dimensional system is in its plane (x, y), y up;
/// in a three-dimensional one z is up.
struct ForeignFrame {
  std::int64_t step = 0;
  long line = 0;  ///< of the file where the frame begins
  std::optional<double> time;
  std::optional<int> phase;            ///< k, only when written
  std::optional<std::int64_t> cycle;   ///< j, only when written
  std::optional<double> plate_height;  ///< only when written
  std::array<bool, 3> periodic{};
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  std::vector<ForeignBead> beads;
  std::vector<ForeignContact> contacts;      ///< only when written
  std::vector<std::vector<double>> numbers;  ///< [ForeignColumns::numbers][beads], only when written
};

/// A vector in the axes of a picture: x to the right, y downwards, z into the depth (3D only).
inline Vec3 to_picture(const Vec3& v, int dimension) {
  return dimension == 3 ? Vec3(v.x(), -v.z() + 0.0, v.y()) : Vec3(v.x(), -v.y() + 0.0, v.z());
}
/// The inverse of to_picture.
/// \param y_up y increases upwards
inline Vec3 from_picture(const Vec3& v, int dimension, bool y_up) {
  const double height = y_up ? v.y() : -v.y() + 0.0;
  return dimension == 3 ? Vec3(v.x(), v.z(), height) : Vec3(v.x(), height, v.z());
}

/// Sets the box of a frame that comes without one: it contains the origin and all beads.
void enclose(ForeignFrame& s, int dimension);

/// The quantities that the frames of a file have, besides id and position.
struct ForeignColumns {
  bool type = false, radius = false, mass = false, uncertainty = false;
  bool tracer = false;               ///< type 2 marks tracers, whatever else is stated; only when read
  bool phase = false;                ///< only when written
  bool contacts = false;             ///< only when written
  std::vector<std::string> numbers;  ///< names of further numbers of each bead, only when written
  std::array<bool, 3> velocity{}, spin{};
  /// Coordinates that come without the number of periods, so that they may be wrapped
  /// (wrapped_positions.hpp).
  std::array<bool, 3> wrapped{};
};

/// Reads the frames of a file one after another.
class ForeignReader {
 public:
  explicit ForeignReader(const std::filesystem::path& file) : file_(file) {}
  ForeignReader(const ForeignReader&) = delete;
  ForeignReader& operator=(const ForeignReader&) = delete;
  virtual ~ForeignReader() = default;

  /// Reads the next frame.
  /// \returns false at the end of the file
  /// \throws InputError naming file and line for anything malformed
  virtual bool next(ForeignFrame& s) = 0;
  /// Known once the first frame has been read.
  [[nodiscard]] virtual const ForeignColumns& columns() const = 0;
  /// What was assumed where the file is silent, as a sentence; otherwise empty.
  [[nodiscard]] virtual std::string assumption() const { return {}; }
  /// The unit of length that the file states; otherwise empty.
  [[nodiscard]] virtual std::string length_unit() const { return {}; }
  /// The unit of time that the file states for its times and velocities; otherwise empty.
  [[nodiscard]] virtual std::string time_unit() const { return {}; }
  /// A vector of the file in the axes of ForeignFrame.
  [[nodiscard]] virtual Vec3 upright(const Vec3& v) const { return v; }
  /// Bytes of the file, and how many of them have been read.
  [[nodiscard]] virtual std::int64_t size() const = 0;
  [[nodiscard]] virtual std::int64_t done() const = 0;
  /// \throws InputError with the file's name and `line`; line 0: of the file as a whole
  [[noreturn]] void fail_at(long line, const std::string& complaint) const;

 protected:
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// The number that `word` is.
  /// \throws InputError as fail_at if it is not a whole or not a finite number
  /// \param may_be_nan NaN is a number too: a velocity that is unknown
  [[nodiscard]] std::int64_t whole_at(long line, std::string_view word) const;
  [[nodiscard]] double number_at(long line, std::string_view word, bool may_be_nan = false) const;
  /// The integer that `value` is; nothing if it is none, or above kExact in size, where doubles skip
  /// integers.
  [[nodiscard]] static std::optional<std::int64_t> integer_of(double value);
  static constexpr double kExact = 9e15;

 private:
  std::filesystem::path file_;
};

/// Writes frames to a file, or to a folder with one file for each.
class ForeignWriter {
 public:
  ForeignWriter() = default;
  ForeignWriter(const ForeignWriter&) = delete;
  ForeignWriter& operator=(const ForeignWriter&) = delete;
  virtual ~ForeignWriter() = default;

  /// \throws RunError if the frame cannot be stored
  virtual void append(const ForeignFrame& s) = 0;
  /// Writes what follows the last frame and closes.
  /// \throws RunError as append
  virtual void finish() = 0;
};

}  // namespace twincell
