// The file of the ISBI particle tracking challenge, which Icy and the tracking tools of Fiji exchange: a list
// of particles with their detections. y increases downwards, as in a picture. Only written here; TrackMate's
// reader reads it. Source: Chenouard et al., Nature Methods 11, 281 (2014); bioimageanalysis.org/track.

#include <fmt/format.h>

#include <map>

#include "core/escape.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

constexpr const char* kIsbiMark = "<!-- tracks written by twincell -->";

class IsbiWriter final : public ForeignWriter {
 public:
  IsbiWriter(const std::filesystem::path& part, const WriteOptions& options) : out_(part), options_(options) {
    // The challenge names its data by noise, density and scenario, which readers require and do not use.
    out_.text() = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n<root>\n<TrackContestISBI2012 SNR=\"\" density=\"\" "
        "scenario=\"{}\" generationDateTime=\"\">\n",
        kIsbiMark, html_text(options.stem));
  }

  void append(const ForeignFrame& s) override {
    for (const ForeignBead& bead : s.beads) {
      const Vec3 r = to_picture(bead.position, options_.dimension);
      fmt::format_to(std::back_inserter(track_of_[bead.id]),
                     "<detection t=\"{}\" x=\"{}\" y=\"{}\" z=\"{}\"/>\n", n_frames_, r.x(), r.y(), r.z());
    }
    ++n_frames_;
  }

  void finish() override {
    for (const auto& [bead, track] : track_of_) {
      out_.text() += "<particle>\n" + track + "</particle>\n";
      out_.flush_if_large();
    }
    out_.text() += "</TrackContestISBI2012>\n</root>\n";
    out_.close();
  }

 private:
  TextOutput out_;
  WriteOptions options_;
  std::map<std::int64_t, std::string> track_of_;
  std::int64_t n_frames_ = 0;
};

}  // namespace

extern const ForeignFormat isbi_format;
const ForeignFormat isbi_format = {
    .word = "isbi",
    .extensions = ".xml",
    .help = "tracks of the ISBI challenge (y downwards): Icy, Fiji; read as trackmate",
    .open = nullptr,
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<IsbiWriter>(part, options); },
    .mark = kIsbiMark};

}  // namespace twincell
