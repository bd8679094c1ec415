#pragma once
/// \file
/// A sweep on the disk: one folder per point, which any number of processes may work in.

#include <filesystem>
#include <optional>
#include <string>

#include "core/error.hpp"
#include "sweep/plan.hpp"

namespace twincell::sweep {

/// The disk did not take a result. Exit code 5: what is done stays done.
class NotStored : public Error {
 public:
  explicit NotStored(const std::string& sentence) : Error(ExitCode::partial, sentence) {}
};

/// The right to compute one point, held until it is destroyed or its process ends, however that ends.
class Claim {
 public:
  explicit Claim(int file) : file_(file) {}
  Claim(Claim&& other) noexcept;
  Claim& operator=(Claim&& other) noexcept;
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  ~Claim();

 private:
  int file_;
};

/// FOLDER/points/ID/point.json (scene and place in the plan), result.json (there when the point is done,
/// whole or not at all, with the SHA-256 of its content), lock, and trajectory.h5 if it is kept.
class Store {
 public:
  enum class Access { read, write };
  /// To write, makes the folder. \throws ConfigError if it cannot be made or written to, or is not a sweep's
  explicit Store(std::filesystem::path folder, Access access = Access::write);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path of(const Point& point) const { return folder_ / "points" / point.id; }
  /// Writes point.json unless it is there. \pre the point is claimed \throws NotStored
  void announce(const Plan& plan, const Point& point) const;
  /// The text of result.json, if the point is done. \throws InputError if it is damaged or another point's
  [[nodiscard]] std::optional<std::string> result(const Point& point) const;
  /// The right to compute a point; nothing if somebody else has it. On file systems without locks everybody
  /// gets it: two would then write the same bytes, one after the other. \throws NotStored
  [[nodiscard]] std::optional<Claim> claim(const Point& point) const;
  /// Whether somebody computes it now.
  [[nodiscard]] bool claimed(const Point& point) const;
  /// \throws NotStored
  void keep(const Point& point, const std::string& result) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace twincell::sweep
