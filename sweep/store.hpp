#pragma once
/// \file
/// A sweep on disk: one folder per point; any number of processes may work in it.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "sweep/plan.hpp"

namespace twincell::sweep {

/// A result could not be stored. Exit code 5: the results stored so far are kept.
class NotStored : public Error {
 public:
  explicit NotStored(const std::string& sentence) : Error(ExitCode::partial, sentence) {}
};

/// Exclusive right to compute one point. It lasts until the object is destroyed or its process ends for any
/// reason.
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

/// Files FOLDER/points/ID/point.json (scene and place in the plan), result.json (exists when the point is
/// done; written atomically, with the SHA-256 of its content), lock, and trajectory.h5 if trajectories are
/// kept.
class Store {
 public:
  enum class Access { read, write };
  /// With write access, creates the folder.
  /// \throws ConfigError if it cannot be created or written to, or is not the folder of a sweep
  explicit Store(std::filesystem::path folder, Access access = Access::write);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path of(const Point& point) const { return folder_ / "points" / point.id; }
  /// Writes point.json unless it exists.
  /// \pre the point is claimed
  /// \throws NotStored
  void announce(const Plan& plan, const Point& point) const;
  /// The text of result.json if the point is done.
  /// \throws InputError if it is damaged or belongs to another point
  [[nodiscard]] std::optional<std::string> result(const Point& point) const;
  /// Claims a point; empty if another process has claimed it. On file systems without locks every process
  /// gets the claim; two processes would then write the same bytes, one after the other.
  /// \throws NotStored
  [[nodiscard]] std::optional<Claim> claim(const Point& point) const;
  /// Whether a process computes the point now.
  [[nodiscard]] bool claimed(const Point& point) const;
  /// The identifiers of all points with a result, of this plan or another.
  [[nodiscard]] std::vector<std::string> finished() const;
  /// Writes result.json.
  /// \throws NotStored
  void keep(const Point& point, const std::string& result) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace twincell::sweep
