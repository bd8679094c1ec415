#include "twin/cell_draft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/escape.hpp"
#include "core/placeholder.hpp"
#include "imaging/refine/refiner.hpp"
#include "trajectory/unit_checks.hpp"

namespace twincell::twin {
namespace {

/// Errors beyond which a small quantity is written as a key instead of a comment.
constexpr double kSignificant = 4;

double relative(const calibration::Estimate& e) {
  return std::isfinite(e.error) ? e.error / e.value : 0;
}

/// Estimate of a product of powers, with the sum of the squared relative errors.
calibration::Estimate with_errors(double value, std::initializer_list<double> relative_errors) {
  double squares = 0;
  for (const double r : relative_errors) squares += r * r;
  return {value, std::abs(value) * std::sqrt(squares)};
}

class Draft {
 public:
  Draft(const CellSurvey& survey, const CellAnswers& answers) : s_(survey), a_(answers) {}
  CellDraft done() {
    scale();
    camera();
    cell();
    drive();
    laboratory();
    doubts();
    return std::move(out_);
  }

 private:
  void measured(const std::string& key, const calibration::Estimate& e, const std::string& how) {
    out_.keys.push_back({key, value_text(e), fmt::format("+- {}: {}", error_text(e.error), how), {e}});
  }
  void stated(const std::string& key, const std::string& value, const std::string& comment) {
    out_.keys.push_back({key, value, comment, {}});
  }
  void open(const std::string& key, const std::string& what, const std::string& comment) {
    out_.keys.push_back({key, fmt::format("\"{}{}\"", kPlaceholder, what), comment, {}, true});
  }

  /// Whether the distance of touching beads is known well enough for a scale; in a gas few beads touch.
  [[nodiscard]] bool spacing_is_clear() const {
    constexpr double kClear = 2e-3;  // relative error
    return s_.beads->spacing && relative(*s_.beads->spacing) < kClear;
  }
  /// \pre spacing_is_clear() \param width of the discs
  void scale_by_spacing(const calibration::Estimate& width) {
    scale_ = s_.beads->spacing;
    disc_width_ = width;
    how_scale_ = fmt::format("distance of touching beads in {} frames; the discs are {} px wide",
                             s_.beads->frames, value_text(width));
  }

  /// Where discs that are not plain end depends on the light.
  void scale_of_shaded_discs(const calibration::Estimate& seen) {
    if (s_.diameter_stated) {
      scale_ = calibration::Estimate{s_.diameter_px, 0};
      how_scale_ = fmt::format("stated with --diameter; the discs are {} px wide", value_text(seen));
      disc_width_ = seen;
    } else if (spacing_is_clear()) {
      scale_by_spacing(seen);
    }
  }

  /// Touching beads are one diameter apart. Discs of another width have rims that glare, overexposure or a
  /// grey level of their own moves.
  void scale_of_plain_discs(const calibration::Estimate& width) {
    constexpr double kMinErrors = 5, kMinDifference = 1e-3, kNoted = 0.02;
    if (s_.diameter_stated || !spacing_is_clear()) return;
    const calibration::Estimate& apart = *s_.beads->spacing;
    const double least =
        std::max(kMinErrors * std::hypot(width.error, apart.error), kMinDifference * apart.value);
    if (std::abs(width.value - apart.value) <= least) return;
    scale_by_spacing(width);
    if (std::abs(width.value - apart.value) > kNoted * apart.value)
      out_.notes.push_back(fmt::format(
          "the discs are {} +- {} px wide, and touching ones {} +- {} px apart: glare, exposure or their "
          "grey "
          "level moves the rims; the distance is taken for the bead diameter",
          value_text(width), error_text(width.error), value_text(apart), error_text(apart.error)));
  }

  /// Scale and the diameter of a bead in mm.
  void scale() {
    sigma_mm_ = a_.sigma_mm ? std::optional(calibration::Estimate{*a_.sigma_mm, 0}) : std::nullopt;
    std::optional<calibration::Estimate> width;
    if (s_.has_walls()) width = calibration::Estimate{s_.geometry->width_px(), s_.geometry->width_error_px()};
    std::optional<calibration::Estimate> diameter;
    if (s_.beads) diameter = s_.beads->diameter;
    if (width && a_.width_mm && a_.sigma_mm) {
      scale_ = with_errors(width->value * *a_.sigma_mm / *a_.width_mm, {relative(*width)});
      how_scale_ = "distance of the walls in px over cell.width";
      constexpr double kMinErrors = 5, kMinDifference = 0.01;
      if (diameter)
        if (const double apart = diameter->value - scale_->value;
            std::abs(apart) >
            std::max(kMinErrors * std::hypot(diameter->error, scale_->error), kMinDifference * scale_->value))
          out_.notes.push_back(
              fmt::format("the walls give {} px per bead and the beads measure {} px: bead diameter ({:g} "
                          "mm) and width ({:g} mm) do not fit together",
                          value_text(*scale_), value_text(*diameter), *a_.sigma_mm, *a_.width_mm));
    } else if (diameter) {
      scale_ = diameter;
      how_scale_ = fmt::format("mean diameter of {} discs in {} frames", s_.beads->sizes, s_.beads->frames);
      const bool plain = imaging::refiner_named(s_.refine).model == imaging::DiscModel::plain;
      if (s_.other_diameters_px.empty())
        plain ? scale_of_plain_discs(*diameter) : scale_of_shaded_discs(*diameter);
      diameter = scale_;
      if (width && a_.width_mm) {
        sigma_mm_ = with_errors(*a_.width_mm * diameter->value / width->value,
                                {relative(*diameter), relative(*width)});
        how_sigma_ = "bead diameter over the distance of the walls, in px, times cell.width_mm";
      }
    }
    if (scale_) out_.pixels_per_sigma = scale_->value;
  }

  void camera() {
    if (scale_ && scale_->error == 0)
      stated("camera.pixels_per_sigma", value_text(*scale_), how_scale_);
    else if (scale_)
      measured("camera.pixels_per_sigma", *scale_, how_scale_);
    else
      open("camera.pixels_per_sigma", "bead diameter in px", "");
    if (scale_ && scale_->error > 0 && std::isfinite(scale_->error))
      stated("camera.scale_error_px", error_text(scale_->error), "standard error of pixels_per_sigma");
    if (scale_ && disc_width_)
      measured(
          "camera.disc_width_px", *disc_width_,
          "width of the discs, whose rims glare, exposure or their grey level moves; radii are measured in "
          "it");
    origin();
    phases();
    if (const auto& g = s_.geometry) {
      if (g->has_plate)
        significant("camera.rotation_deg", {g->rotation_deg, g->fit.standard_error("rotation")},
                    "slope of the plate, counter-clockwise");
      if (g->distortion != 0)
        measured("camera.distortion", {g->distortion, *g->distortion_error}, "bend of walls and plate");
    }
    if (s_.bright) stated("camera.bright", "true", "the beads are brighter than the background");
    if (s_.refine != imaging::RefineOptions{}.method)
      stated("camera.refine", fmt::format("\"{}\"", s_.refine), "the method that suits these discs");
    if (a_.frame_rate_hz)
      stated("camera.frame_rate_hz", fmt::format("{:.10g}", *a_.frame_rate_hz), "as stated");
    else if (s_.playback_hz && !s_.frame_rate_hz && a_.frequency_hz && s_.drive)
      // The stated key keeps a playback rate of the film from contradicting the drive.
      stated("camera.frame_rate_hz", fmt::format("{:.7g}", *a_.frequency_hz * s_.drive->period),
             "stated frequency times the frames per cycle; the film's own rate is that of playback");
  }

  void significant(const std::string& key, const calibration::Estimate& e, const std::string& how) {
    if (std::abs(e.value) > kSignificant * e.error) measured(key, e, how);
  }

  void origin() {
    constexpr const char* kWhat =
        "foot of the left wall, plate at its mean height; picture without rotation and "
        "distortion";
    const bool left = s_.geometry && s_.geometry->has_left;
    if (left && s_.plate_row) {
      const calibration::Estimate x{s_.geometry->fit.value("x_left"),
                                    s_.geometry->fit.standard_error("x_left")};
      out_.keys.push_back(
          {"camera.origin_px",
           fmt::format("[{}, {}]", value_text(x), value_text(*s_.plate_row)),
           fmt::format("+- {}, {}: {}", error_text(x.error), error_text(s_.plate_row->error), kWhat),
           {x, *s_.plate_row}});
      return;
    }
    std::string known;
    if (left) known = fmt::format("x = {:.2f} is measured", s_.geometry->fit.value("x_left"));
    if (s_.plate_row) known = fmt::format("y = {:.2f} is measured", s_.plate_row->value);
    if (!s_.plate_row && s_.geometry && s_.geometry->has_plate)
      known += fmt::format("{}the plate of the first frame is at row {:.2f}", known.empty() ? "" : "; ",
                           s_.geometry->plate_row - s_.geometry->heights.front().height_px);
    open("camera.origin_px", "[x, y] of the lower left inside corner in px, plate at its mean height", known);
  }

  void phases() {
    if (!s_.drive) {
      frames_per_cycle_of_rates();
      open("camera.first_phase", "phase of the first frame, 0 to frames_per_cycle - 1",
           "phase 0: the plate passes its mean height upwards");
      return;
    }
    const calibration::DriveFit& d = *s_.drive;
    if (d.frames_per_cycle == 0) return;
    stated("camera.frames_per_cycle", fmt::format("{}", d.frames_per_cycle),
           fmt::format("period of the {}: {} +- {} frames", s_.plate_of_bed ? "bed" : "plate",
                       value_text({d.period, d.period_error}), error_text(d.period_error)));
    stated("camera.first_phase", fmt::format("{}", d.first_phase),
           "of the first frame; phase 0: the plate passes its mean height upwards");
    significant("camera.phase_offset", {d.phase_offset, d.phase_offset_error},
                "frames by which every frame is late");
  }

  /// The frames per cycle of a film that shows no plate: the frame rate over the frequency, if they stay in
  /// step over the film.
  void frames_per_cycle_of_rates() {
    constexpr double kMaxDrift = 0.25;  // frames over the film
    const auto rate = a_.frame_rate_hz ? a_.frame_rate_hz : s_.frame_rate_hz;
    const double period = rate && a_.frequency_hz ? *rate / *a_.frequency_hz : 0, whole = std::round(period);
    const double drift =
        period > 0 ? std::abs(period - whole) * static_cast<double>(s_.n_frames) / period : 0;
    if (whole >= 2 && drift <= kMaxDrift)
      stated("camera.frames_per_cycle", fmt::format("{:.0f}", whole),
             fmt::format("frame rate over frequency, {:.10g}/s over {:.10g} Hz, as stated", *rate,
                         *a_.frequency_hz));
    else
      open("camera.frames_per_cycle", "number of frames per cycle of the shaker",
           (period > 0 ? fmt::format("frame rate over frequency is {:.6g}, no whole number; ", period) : "") +
               "not needed by track --phase-lock found, which uses the motion of the bed");
  }

  void cell() {
    if (a_.width_mm) {
      stated("cell.width_mm", fmt::format("{:.10g}", *a_.width_mm), "as stated");
    } else if (s_.has_walls() && scale_) {
      const calibration::Estimate w{s_.geometry->width_px(), s_.geometry->width_error_px()};
      measured("cell.width_sigma", with_errors(w.value / scale_->value, {relative(w), relative(*scale_)}),
               fmt::format("walls {} px apart{}", value_text(w),
                           s_.walls_of_bed ? ", from the beads that touch them" : " at the plate"));
    } else {
      open("cell.width_sigma", "distance of the side walls in bead diameters",
           s_.has_walls() ? fmt::format("the walls are {:.2f} px apart", s_.geometry->width_px())
                          : "or replace this key by width_mm");
    }
    if (s_.has_walls()) {
      stated("cell.sides", "\"walls\"",
             s_.walls_of_bed ? "beads pile up at both sides" : "both walls are seen");
      const auto& fit = s_.geometry->fit;
      const calibration::Estimate l{fit.value("tilt_left"), fit.standard_error("tilt_left")},
          r{fit.value("tilt_right"), fit.standard_error("tilt_right")};
      // A camera that drifts, a coarse JPEG or text in the picture tilt a wall by less than this, which
      // shifts it by 0.02 sigma over ten beads.
      constexpr double kMinTilt = 0.1;  // degrees
      const auto tilted = [&](const calibration::Estimate& e) {
        return std::abs(e.value) > std::max(kSignificant * e.error, kMinTilt);
      };
      if (tilted(l) || tilted(r))
        out_.keys.push_back(
            {"cell.side_tilt",
             fmt::format("[{}, {}]", value_text(l), value_text(r)),
             fmt::format("+- {}, {}: degrees outward", error_text(l.error), error_text(r.error)),
             {l, r}});
    } else {
      open("cell.sides", "walls, periodic or open", "");
    }
  }

  /// The frequency in hertz, stated or measured.
  [[nodiscard]] std::optional<calibration::Estimate> frequency() const {
    if (a_.frequency_hz) return calibration::Estimate{*a_.frequency_hz, 0};
    const auto rate = a_.frame_rate_hz ? a_.frame_rate_hz : s_.frame_rate_hz;
    if (!rate || !s_.drive) return std::nullopt;
    return with_errors(*rate / s_.drive->period, {s_.drive->period_error / s_.drive->period});
  }

  /// A second harmonic that is clearly there. Its acceleration is four times its share of A.
  void harmonic() {
    constexpr double kMinErrors = 5, kMinDifference = 0.01;
    if (!s_.drive || !s_.drive->second_harmonic) return;
    const calibration::DriveFit& d = *s_.drive;
    if (*d.second_harmonic < std::max(kMinDifference, kMinErrors * *d.second_harmonic_error)) return;
    const calibration::Estimate share{*d.second_harmonic, *d.second_harmonic_error},
        phase{*d.second_harmonic_phase, share.error / (2 * std::numbers::pi * share.value)};
    out_.keys.push_back(
        {"drive.harmonics",
         fmt::format("[[{}, {}]]", value_text(share), value_text(phase)),
         fmt::format("+- {}, {}: second harmonic over A, and its phase, from the plate's edge",
                     error_text(share.error), error_text(phase.error)),
         {share, phase}});
  }

  void drive() {
    std::optional<calibration::Estimate> amplitude;
    if (s_.drive && scale_) {
      const calibration::Estimate px{s_.drive->amplitude, s_.drive->amplitude_error};
      amplitude = with_errors(px.value / scale_->value, {relative(px), relative(*scale_)});
      measured("drive.amplitude_sigma", *amplitude,
               fmt::format("{}, {} +- {} px", s_.plate_of_bed ? "lower side of the bed" : "plate's edge",
                           value_text(px), error_text(px.error)));
    }
    harmonic();
    const auto f = frequency();
    const bool hertz = f && sigma_mm_;  // the frequency in reduced units needs the scale
    if (amplitude && hertz) {
      const double w = 2 * std::numbers::pi * f->value;
      constexpr double kMm = 1e-3;
      out_.gamma = with_errors(amplitude->value * sigma_mm_->value * kMm * w * w / a_.gravity_m_s2,
                               {relative(*amplitude), relative(*sigma_mm_), 2 * relative(*f)});
    }
    if (a_.gamma && amplitude && out_.gamma) contradiction();
    const bool by_gamma = a_.gamma && !a_.frequency_hz;
    if (by_gamma || (a_.gamma && (!amplitude || !hertz))) {
      stated("drive.gamma", fmt::format("{:.10g}", *a_.gamma), "A omega^2/g, as stated");
      if (amplitude) {
        out_.gamma = calibration::Estimate{*a_.gamma, 0};
        return;
      }
    }
    if (f && (a_.frequency_hz || s_.drive))
      a_.frequency_hz ? stated("drive.frequency_hz", fmt::format("{:.10g}", f->value), "as stated")
                      : measured("drive.frequency_hz", *f,
                                 fmt::format("{:.7g} frames per second over the period in frames",
                                             f->value * s_.drive->period));
    else
      open("drive.frequency_hz", "frequency of the shaker in Hz",
           "or replace it by gamma = A omega^2/g; then sigma_mm is not needed either");
    needs_sigma_ = true;
    if (!amplitude && !a_.gamma)
      open("drive.gamma", "peak acceleration of the plate over g, A omega^2/g",
           "or replace it by amplitude_mm");
    else if (amplitude && out_.gamma)
      out_.keys.back().comment +=
          fmt::format("; Gamma = {} +- {}", value_text(*out_.gamma), error_text(out_.gamma->error));
  }

  /// Notes a stated Gamma that differs from that of amplitude and frequency.
  void contradiction() {
    constexpr double kMinErrors = 5, kMinDifference = 0.03;
    const double apart = *a_.gamma - out_.gamma->value;
    if (std::abs(apart) > std::max(kMinErrors * out_.gamma->error, kMinDifference * *a_.gamma))
      out_.notes.push_back(
          fmt::format("Gamma = {:g} is stated, but the plate's amplitude and the frequency give {} +- {}",
                      *a_.gamma, value_text(*out_.gamma), error_text(out_.gamma->error)));
  }

  void laboratory() {
    if (sigma_mm_ && how_sigma_.empty())
      stated("scale.sigma_mm", fmt::format("{:.10g}", sigma_mm_->value), "bead diameter, as stated");
    else if (sigma_mm_)
      measured("scale.sigma_mm", *sigma_mm_, how_sigma_);
    else if (needs_sigma_ || a_.width_mm)
      open("scale.sigma_mm", "bead diameter in mm", "");
    if (sigma_mm_ || needs_sigma_ || a_.width_mm)
      stated("scale.gravity_m_s2", fmt::format("{:.10g}", a_.gravity_m_s2), "");
  }

  void doubts() {
    ShakenCell numbers{.sigma_mm = a_.sigma_mm,
                       .frequency_hz = a_.frequency_hz,
                       .gamma = a_.gamma,
                       .gravity_m_s2 = a_.gravity_m_s2};
    if (out_.gamma) numbers.gamma = out_.gamma->value;
    for (const std::string& doubt : implausible_numbers(numbers)) out_.notes.push_back(doubt);
    constexpr double kSame = 0.03;  // as in the check of a stated drive
    const std::optional<double> rate = a_.frame_rate_hz ? a_.frame_rate_hz : s_.frame_rate_hz;
    if (!rate || !a_.frequency_hz || !s_.drive) return;
    if (const double seen = *rate / s_.drive->period; std::abs(seen / *a_.frequency_hz - 1) > kSame)
      out_.notes.push_back(fmt::format(
          "{:g} frames per second and a period of {:.5g} frames give a frequency of {:.4g} Hz, but "
          "{:g} Hz is stated",
          *rate, s_.drive->period, seen, *a_.frequency_hz));
  }

  const CellSurvey& s_;
  const CellAnswers& a_;
  CellDraft out_;
  std::optional<calibration::Estimate> scale_, disc_width_, sigma_mm_;
  std::string how_scale_, how_sigma_;
  bool needs_sigma_ = false;
};

int decimals(double error) {
  constexpr int kMaxDigits = 9;
  if (!(error > 0) || !std::isfinite(error)) return -1;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, kMaxDigits);
}

}  // namespace

std::string value_text(const calibration::Estimate& e) {
  const int n = decimals(e.error);
  return n < 0 ? fmt::format("{:.10g}", e.value) : fmt::format("{:.{}f}", e.value, n);
}

std::string error_text(double error) {
  return std::isfinite(error) ? fmt::format("{:.2g}", error) : "unknown";
}

const DraftKey* CellDraft::find(const std::string& key) const {
  const auto it = std::find_if(keys.begin(), keys.end(), [&](const DraftKey& k) { return k.key == key; });
  return it == keys.end() ? nullptr : &*it;
}

CellDraft draft_cell(const CellSurvey& survey, const CellAnswers& answers) {
  return Draft(survey, answers).done();
}

std::string cell_text(const CellDraft& draft, const CellSurvey& survey, const std::string& head) {
  constexpr int kComment = 40;
  std::string text =
      head +
      "\n# Measured values have their standard error in the comment (+-); docs/cell.md explains "
      "every key.\n";
  const auto opened =
      std::count_if(draft.keys.begin(), draft.keys.end(), [](const DraftKey& k) { return k.open; });
  if (opened > 0)
    text += fmt::format("# {} value{} still needed: replace each text \"{}...\" by a number or word.\n",
                        opened, opened == 1 ? " is" : "s are", kPlaceholder);
  for (const NotMeasured& m : survey.missing)
    text += "# " +
            one_line(fmt::format("Not measured: {}, because {}. Remedy: {}.", m.what, m.why, m.remedy)) +
            "\n";
  std::string table;
  for (const DraftKey& k : draft.keys) {
    const std::size_t dot = k.key.find('.');
    if (k.key.substr(0, dot) != table) {
      table = k.key.substr(0, dot);
      text += "\n[" + table + "]\n";
    }
    const std::string line = k.key.substr(dot + 1) + " = " + k.value;
    text += k.comment.empty() ? line + "\n" : fmt::format("{:<{}}  # {}\n", line, kComment, k.comment);
  }
  return text;
}

}  // namespace twincell::twin
