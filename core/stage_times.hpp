#pragma once
/// \file
/// Where the time of a run goes: elapsed time and amount of work of each named stage.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace twincell {

/// Elapsed time of the stages of one run, on the thread that hands the work out.
///
/// One stage is timed at every instant: a stage that begins inside another suspends it, and the time between
/// stages belongs to "other". The times therefore add up to the time since the construction, without
/// overlap. Elapsed time rather than processor time, because it is what a user waits for and what more
/// threads shorten; process_cpu_seconds() in cpu_clock.hpp states next to it how many processors were busy.
///
/// A change of stage costs one reading of the clock and a search in a short list. Stages are therefore coarse
/// pieces, such as a frame or a call of a solver, never parts of an inner loop. An object belongs to one
/// thread.
class StageTimes {
 public:
  /// Seconds since an arbitrary origin.
  using Clock = double (*)();

  /// Time and work of one stage.
  struct Row {
    std::string name;
    std::string unit;    ///< kind of the pieces of work, in the plural: "beads"; empty: not counted
    double seconds = 0;  ///< elapsed
    double count = 0;    ///< pieces of work
    double bytes = 0;    ///< bytes that the work cannot do without moving; 0: not counted
    /// Pieces of work per second; 0 if the work is not counted or took no time.
    [[nodiscard]] double per_second() const { return seconds > 0 ? count / seconds : 0; }
    /// Bytes per second, to be compared with memory_bandwidth(); 0 likewise.
    [[nodiscard]] double bytes_per_second() const { return seconds > 0 ? bytes / seconds : 0; }
  };

  /// The time starts now.
  /// \param clock for tests
  explicit StageTimes(Clock clock = &elapsed_seconds);

  /// The stages in the order in which they were first entered, "other" last. Includes the time until now.
  [[nodiscard]] std::vector<Row> rows() const;

  /// Adds the rows of another thread to `sum`, each to the row of its name. "other" stays last.
  static void add(const std::vector<Row>& rows, std::vector<Row>& sum);

  /// A monotonic clock, s.
  static double elapsed_seconds();

 private:
  friend class Stage;
  std::size_t change_to(std::size_t stage);
  std::size_t find(std::string_view name, std::string_view unit);

  Clock clock_;
  double since_;
  std::size_t running_ = 0;
  static constexpr std::string_view kOther = "other";
  std::vector<Row> stages_{{.name = std::string(kOther), .unit = {}}};  ///< index 0: no stage
};

/// Times a stage during the lifetime of the object. To add a stage to a profile, declare one:
///
///     Stage writing(times, "writing", "frames");
///     writing.count(1);
class Stage {
 public:
  /// \param times null: nothing is timed
  /// \param unit as in Row; that of the first entry applies
  Stage(StageTimes* times, std::string_view name, std::string_view unit = {});
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();
  /// Adds to the work of the stage.
  /// \param bytes as in Row
  void count(double pieces, double bytes = 0);

 private:
  StageTimes* times_;
  std::size_t stage_ = 0, suspended_ = 0;
};

}  // namespace twincell
