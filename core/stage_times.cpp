#include "core/stage_times.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace twincell {

double StageTimes::elapsed_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

StageTimes::StageTimes(Clock clock) : clock_(clock), since_(clock()) {}

std::vector<StageTimes::Row> StageTimes::rows() const {
  std::vector<Row> all = stages_;
  all[running_].seconds += clock_() - since_;
  std::rotate(all.begin(), all.begin() + 1, all.end());
  return all;
}

void StageTimes::add(const std::vector<Row>& rows, std::vector<Row>& sum) {
  for (const Row& row : rows) {
    auto same = std::find_if(sum.begin(), sum.end(), [&](const Row& r) { return r.name == row.name; });
    if (same == sum.end()) {
      const bool ends_with_other = !sum.empty() && sum.back().name == kOther;
      same = sum.insert(ends_with_other ? sum.end() - 1 : sum.end(), {.name = row.name, .unit = row.unit});
    }
    same->seconds += row.seconds;
    same->count += row.count;
    same->bytes += row.bytes;
  }
}

std::size_t StageTimes::change_to(std::size_t stage) {
  const double now = clock_();
  stages_[running_].seconds += now - since_;
  since_ = now;
  return std::exchange(running_, stage);
}

std::size_t StageTimes::find(std::string_view name, std::string_view unit) {
  for (std::size_t k = 1; k < stages_.size(); ++k)
    if (stages_[k].name == name) return k;
  stages_.push_back({.name = std::string(name), .unit = std::string(unit)});
  return stages_.size() - 1;
}

Stage::Stage(StageTimes* times, std::string_view name, std::string_view unit) : times_(times) {
  if (times_ == nullptr) return;
  stage_ = times_->find(name, unit);
  suspended_ = times_->change_to(stage_);
}

Stage::~Stage() {
  if (times_ != nullptr) times_->change_to(suspended_);
}

void Stage::count(double pieces, double bytes) {
  if (times_ == nullptr) return;
  times_->stages_[stage_].count += pieces;
  times_->stages_[stage_].bytes += bytes;
}

}  // namespace twincell
