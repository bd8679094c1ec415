#include "cli/located_frames.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "core/error.hpp"
#include "core/plural.hpp"
#include "imaging/disc/position_error.hpp"

namespace twincell::cli {

namespace {

constexpr const char* kCandidateHeading = "frame,x,y,radius,darkness,interior,score,ring_share,verdict\n";
constexpr const char* kBeadHeading =
    "y,x,mass,size,ecc,signal,raw_mass,ep,frame,radius,sigma_x,sigma_y,sigma_radius,score,tracer,edge,"
    "overlap\n";

std::string bead_row(const imaging::Detection& b, std::int64_t frame) {
  const double ep = imaging::position_error(b);
  return fmt::format(
      "{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.2f},{:.5f},{},{:.4f},{:.5f},{:.5f},{:.5f},{:.4f},{},{},{}"
      "\n",
      b.y, b.x, b.mass, b.size, b.ecc, b.signal, b.raw_mass, ep, frame, b.radius, b.sigma_x, b.sigma_y,
      b.sigma_radius, b.score, b.tracer ? 1 : 0, b.edge ? 1 : 0, b.overlap ? 1 : 0);
}

std::string candidate_row(const imaging::Detection& b, std::int64_t frame) {
  return fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{}\n", frame, b.x, b.y, b.radius,
                     b.darkness, b.interior, b.score, b.ring_share, imaging::word_of(b.verdict));
}

nlohmann::json in_words(const std::map<imaging::Verdict, std::size_t>& counts) {
  nlohmann::json words = nlohmann::json::object();
  for (const auto& [why, count] : counts) words[std::string(imaging::word_of(why))] = count;
  return words;
}

}  // namespace

Product table_of_beads() {
  return Product::table(kBeadHeading);
}

Product table_of_candidates() {
  return Product::table(kCandidateHeading);
}

TableFile::TableFile(const std::string& name, const char* heading) : name_(name) {
  if (name.empty()) return;
  path_.emplace(name, Product::table(heading));
  out_.open(path_->part());
  out_ << heading;
}

TableFile& TableFile::operator<<(const std::string& text) {
  if (path_) out_ << text;
  return *this;
}

void TableFile::commit() {
  if (!path_) return;
  errno = 0;
  out_.close();
  if (!out_) {
    // A write that failed before has no error number any more; a further one fails for the same reason.
    if (errno == 0) {
      std::ofstream again(path_->part(), std::ios::app);
      again << std::string(1 << 16, ' ') << std::flush;
    }
    throw RunError(errno == 0 ? name_ + ": cannot be written."
                              : fmt::format("{}: cannot be written ({}).", name_, std::strerror(errno)));
  }
  path_->commit();
}

LocatedFrames::LocatedFrames(const std::string& beads, const std::string& candidates,
                             std::optional<TruthOfFrames> truth, const imaging::ScoredRows& rows)
    : table_(beads, kBeadHeading),
      candidates_(candidates, kCandidateHeading),
      truth_(std::move(truth)),
      scorer_(rows) {}

void LocatedFrames::add(std::int64_t frame, const imaging::Located& located) {
  for (const imaging::Detection& b : located.beads) table_ << bead_row(b, frame);
  for (const std::vector<imaging::Detection>* list : {&located.beads, &located.dropped})
    for (const imaging::Detection& b : *list) candidates_ << candidate_row(b, frame);

  Record record{.frame = frame,
                .beads = located.beads.size(),
                .blur_px = located.blur_px,
                .stages = located.stages,
                .dropped = {}};
  for (const imaging::Detection& b : located.dropped) ++record.dropped[b.verdict];
  for (const auto& [why, count] : record.dropped) left_out_[why] += count;
  beads_ += located.beads.size();
  for (const imaging::Detection& b : located.beads) overlapping_ += b.overlap ? 1 : 0;
  bare_ += located.beads.empty() ? 1 : 0;
  records_.push_back(std::move(record));
  motion_.add(located);

  if (!truth_ || static_cast<std::size_t>(frame) >= truth_->size()) return;
  std::vector<imaging::FoundBead> found;
  for (const imaging::Detection& b : located.beads) found.push_back({b.x, b.y, -1});
  scorer_.add((*truth_)[static_cast<std::size_t>(frame)], found);
}

void LocatedFrames::commit() {
  table_.commit();
  candidates_.commit();
}

std::string LocatedFrames::lines() const {
  std::string text;
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const Record& r = records_[k];
    text += fmt::format("frame {}: {}, edge blur {:.2f} px", r.frame, plural(r.beads, "bead"), r.blur_px);
    if (motion_.claimed(k))
      text += fmt::format(", moved by {:.2f} px during the exposure",
                          std::hypot(motion_.path(k)[0], motion_.path(k)[1]));
    text += ";";
    for (const imaging::StageReport& stage : r.stages) {
      text += fmt::format(" {} {:.1f} ms", stage.stage, 1000 * stage.seconds);
      if (stage.stage != "prepare") text += fmt::format(" ({})", stage.beads);
    }
    text += "\n";
  }
  return text;
}

std::string LocatedFrames::unproven_motion() const {
  const std::size_t unproven = motion_.unproven();
  if (unproven == 0) return {};
  return fmt::format(
      "in {} the edges are blurred more along one direction than across it, though {}: no motion is "
      "concluded from it\n",
      plural(unproven, "frame"),
      frames() == 1 ? "one frame does not show how beads move"
                    : "the beads do not move that far from frame to frame");
}

std::string LocatedFrames::overlaps() const {
  if (overlapping_ == 0) return {};
  return fmt::format(
      "discs overlap in projection, as in two layers: {} of {} do so and are marked, and those that others "
      "hide are missing (--refine overlapping)\n",
      overlapping_, plural(beads_, "bead"));
}

std::string LocatedFrames::doubts() const {
  constexpr double kMany = 0.02;  // of the beads
  std::string text;
  if (bare_ > 0) text += fmt::format("no bead in {} of {} frames\n", bare_, frames());
  std::size_t all = 0, wrong_radius = 0;
  std::string reasons;
  for (const auto& [why, count] : left_out_) {
    if (why == imaging::Verdict::outside || why == imaging::Verdict::in_wall) continue;  // not visible beads
    if (why == imaging::Verdict::wrong_radius) wrong_radius = count;
    all += count;
    reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, imaging::word_of(why));
  }
  const double many = kMany * static_cast<double>(beads_);
  if (static_cast<double>(all) > many)
    text += fmt::format(
        "in addition to {} beads, candidates were left out: {} (--candidates lists them, --overlay shows the "
        "beads)\n",
        beads_, reasons);
  if (static_cast<double>(wrong_radius) > many && wrong_radius > 1)
    text += "to locate beads of several sizes, use --diameter D1 D2 ...\n";
  if (all > beads_)
    text +=
        "more candidates were left out than beads were found: check --overlay; --diameter with --dark or "
        "--bright may give a better result\n";
  return text;
}

std::string LocatedFrames::score_text() const {
  if (!truth_) return {};
  const imaging::Score s = scorer_.score();
  std::string text = fmt::format(
      "against the truth: recall {:.4f}, precision {:.4f}, rms {:.4f} px per coordinate, bias {:+.4f} "
      "{:+.4f} px\n",
      s.recall(), s.precision(), s.rms, s.bias_x, s.bias_y);
  if (s.sure < s.found)
    text += fmt::format("of the {} beads with the most certain truth: rms {:.4f} px\n", s.sure, s.rms_sure);
  return text;
}

nlohmann::json LocatedFrames::document() const {
  nlohmann::json document = {{"frames", nlohmann::json::array()}, {"left_out", in_words(left_out_)}};
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const Record& r = records_[k];
    nlohmann::json f = {
        {"frame", r.frame}, {"beads", r.beads}, {"blur_px", r.blur_px}, {"dropped", in_words(r.dropped)}};
    for (const imaging::StageReport& stage : r.stages)
      f["stages"][stage.stage] = {{"ms", 1000 * stage.seconds}, {"beads", stage.beads}};
    if (motion_.claimed(k)) f["path_px"] = motion_.path(k);
    document["frames"].push_back(std::move(f));
  }
  if (!truth_) return document;
  const imaging::Score s = scorer_.score();
  document["truth"] = {{"recall", s.recall()},      {"precision", s.precision()},  {"rms_px", s.rms},
                       {"rms_sure_px", s.rms_sure}, {"bias_x_px", s.bias_x},       {"bias_y_px", s.bias_y},
                       {"truths", s.truths},        {"false_finds", s.false_finds}};
  return document;
}

}  // namespace twincell::cli
