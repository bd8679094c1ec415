// locate and track in Python: options of the verbs' names, columns as arrays.

#include <fmt/format.h>

#include <functional>
#include <map>

#include "calibration/film/track_film.hpp"
#include "core/error.hpp"
#include "imaging/disc/position_error.hpp"
#include "imaging/preprocess/flat_field.hpp"
#include "imaging/preprocess/open_flattened.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/bed_in_cell.hpp"
#include "imaging/track/locate_stack.hpp"
#include "imaging/track/motion_in_exposure.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "python/frames.hpp"
#include "python/trajectory.hpp"

namespace twincell::python {

namespace {

/// One column of the table of beads: trackpy's columns in trackpy's order, then the additional columns, as
/// `twincell locate` writes them.
struct BeadColumn {
  const char* name;
  double (*of)(const imaging::Detection&);
};
constexpr BeadColumn kColumns[] = {
    {"y", [](const imaging::Detection& b) { return b.y; }},
    {"x", [](const imaging::Detection& b) { return b.x; }},
    {"mass", [](const imaging::Detection& b) { return b.mass; }},
    {"size", [](const imaging::Detection& b) { return b.size; }},
    {"ecc", [](const imaging::Detection& b) { return b.ecc; }},
    {"signal", [](const imaging::Detection& b) { return b.signal; }},
    {"raw_mass", [](const imaging::Detection& b) { return b.raw_mass; }},
    {"ep", [](const imaging::Detection& b) { return imaging::position_error(b); }},
    {"frame", nullptr},
    {"radius", [](const imaging::Detection& b) { return b.radius; }},
    {"sigma_x", [](const imaging::Detection& b) { return b.sigma_x; }},
    {"sigma_y", [](const imaging::Detection& b) { return b.sigma_y; }},
    {"sigma_radius", [](const imaging::Detection& b) { return b.sigma_radius; }},
    {"score", [](const imaging::Detection& b) { return b.score; }},
    {"tracer", nullptr},
    {"edge", nullptr},
    {"overlap", nullptr},
};

/// The beads of all frames.
struct Beads {
  std::vector<std::vector<double>> columns{std::size(kColumns)};  ///< as kColumns; empty where `of` is null
  std::vector<std::int64_t> frame;
  std::vector<std::uint8_t> tracer, edge, overlap;

  void add(const std::vector<imaging::Detection>& detected, std::int64_t number) {
    for (const imaging::Detection& b : detected) {
      for (std::size_t c = 0; c < std::size(kColumns); ++c)
        if (kColumns[c].of != nullptr) columns[c].push_back(kColumns[c].of(b));
      frame.push_back(number);
      tracer.push_back(b.tracer ? 1 : 0);
      edge.push_back(b.edge ? 1 : 0);
      overlap.push_back(b.overlap ? 1 : 0);
    }
  }
};

struct FrameReport {
  std::size_t beads;
  double blur_px;
  std::map<imaging::Verdict, std::size_t> dropped;

  explicit FrameReport(const imaging::Located& located)
      : beads(located.beads.size()), blur_px(located.blur_px) {
    for (const imaging::Detection& b : located.dropped) ++dropped[b.verdict];
  }
};

py::dict in_words(const std::map<imaging::Verdict, std::size_t>& counts) {
  py::dict d;
  for (const auto& [why, count] : counts) d[py::str(std::string(imaging::word_of(why)))] = count;
  return d;
}

void set_diameters(imaging::LocatorOptions& options, const std::vector<double>& diameters) {
  if (diameters.size() > 8)
    throw ConfigError({.file = {}, .key = "diameter"},
                      fmt::format("has {} values; there may be up to 8.", diameters.size()));
  for (const double d : diameters) require_range({.file = {}, .key = "diameter"}, d, 3, 400);
  if (diameters.empty()) return;
  options.diameter_px = diameters.front();
  options.other_diameters_px.assign(diameters.begin() + 1, diameters.end());
}

/// One number, or several. None: none.
std::vector<double> numbers(const py::object& said) {
  if (said.is_none()) return {};
  if (py::isinstance<py::float_>(said) || py::isinstance<py::int_>(said)) return {said.cast<double>()};
  return said.cast<std::vector<double>>();
}

std::unique_ptr<imaging::FrameSource> prepared_stack(const py::object& stack,
                                                     const imaging::LocatingRequest& request,
                                                     const imaging::LocatorOptions& locator) {
  std::string name;
  auto frames = source_of(stack, name);
  if (request.flat == "stack" && name.empty())
    throw ConfigError({.file = {}, .key = "flat"},
                      "'stack' reads the stack twice, so it needs the name of a stack instead of arrays.");
  return unlocked(py::none(), [&](Progress& /*progress*/) {
    return imaging::prepare_frames(std::move(frames), name, request, locator);
  });
}

/// The options of beads and part of a stack, which `locate` and `track` share.
imaging::LocatingRequest locating_request(const py::object& diameter, const std::string& finder,
                                          double min_score, double min_explained, const std::string& refine,
                                          bool bright, bool dark, const std::string& flat,
                                          const std::string& background, const std::string& roi,
                                          const std::string& mask, const std::string& frames) {
  if (bright && dark)
    throw ConfigError({.file = {}, .key = "bright"},
                      "and dark exclude each other; give only one of the two.");
  if (!flat.empty() && !background.empty())
    throw ConfigError({.file = {}, .key = "flat"},
                      "and background exclude each other; give only one of the two.");
  imaging::LocatingRequest request;
  request.locator.finder = finder;
  request.locator.find.min_score = min_score;
  request.locator.judge.min_score = min_explained;
  request.locator.refine.method = refine;
  (void)imaging::refiner_named(refine);
  request.locator.preprocess.bright = bright;
  request.diameters = numbers(diameter);
  imaging::LocatorOptions checked;
  set_diameters(checked, request.diameters);
  request.dark = dark;
  request.flat = flat;
  request.background = background;
  request.roi = roi;
  request.mask = mask;
  request.frames = frames;
  return request;
}

/// The beads as arrays under the names of kColumns.
py::dict columns_of(Beads beads) {
  py::dict columns;
  for (std::size_t c = 0; c < std::size(kColumns); ++c) {
    const std::string name = kColumns[c].name;
    columns[py::str(name)] = kColumns[c].of != nullptr ? array_of(std::move(beads.columns[c]))
                             : name == "frame"         ? array_of(std::move(beads.frame))
                             : name == "tracer"        ? array_of(std::move(beads.tracer))
                             : name == "edge"          ? array_of(std::move(beads.edge))
                                                       : array_of(std::move(beads.overlap));
  }
  return columns;
}

/// The options with which the same beads are found again.
py::dict settings_of(const imaging::LocatorOptions& locator, const imaging::LocatingRequest& request,
                     const std::string& said_frames) {
  py::list diameters;
  diameters.append(locator.diameter_px);
  for (const double other : locator.other_diameters_px) diameters.append(other);
  py::dict settings;
  settings["diameter"] = diameters;
  settings["locator"] = locator.finder;
  settings["min_score"] = locator.find.min_score;
  settings["min_explained"] = locator.judge.min_score;
  settings["refine"] = locator.refine.method;
  settings[locator.preprocess.bright ? "bright" : "dark"] = true;
  settings["flat"] = request.flat;
  settings["background"] = request.background;
  settings["roi"] = request.roi;
  settings["mask"] = request.mask;
  settings["frames"] = said_frames;
  return settings;
}

/// What was found in each frame, as dicts.
py::list per_frame(const std::vector<FrameReport>& reports, const imaging::FrameRange& range,
                   const imaging::MotionInExposure& motion) {
  py::list all;
  for (std::size_t f = 0; f < reports.size(); ++f) {
    py::dict one;
    one["frame"] = range.number(static_cast<std::int64_t>(f));
    one["beads"] = reports[f].beads;
    one["blur_px"] = reports[f].blur_px;
    if (motion.claimed(f)) one["path_px"] = motion.path(f);
    one["dropped"] = in_words(reports[f].dropped);
    all.append(one);
  }
  return all;
}

py::object locate_beads_of(const py::object& said, imaging::LocatingRequest request, int threads,
                           const py::object& callback) {
  const std::string said_frames = request.frames;
  const py::object stack = stack_of_frames(said, request.frames);
  const imaging::LocatorOptions given = imaging::locator_of(request);
  const imaging::Region region = imaging::region_of(request);
  const imaging::FrameRange range = imaging::frames_of(request);
  const int n_threads = threads_of(threads);
  const auto frames = prepared_stack(stack, request, given);
  Beads beads;
  std::vector<FrameReport> reports;
  imaging::MotionInExposure motion;
  std::map<imaging::Verdict, std::size_t> left_out;
  imaging::RegionFrames seen(*frames, region);
  const imaging::LocatorConfiguration found = unlocked(callback, [&](Progress& progress) {
    imaging::FramesAhead ahead(seen);
    imaging::LocatorConfiguration configuration = imaging::configure_locator(ahead, given, n_threads);
    imaging::locate_stack(
        ahead, configuration.locator, n_threads,
        [&](std::int64_t index, const cv::Mat&, const imaging::Located& as_located) {
          const imaging::Located located = imaging::in_whole_picture(as_located, region);
          beads.add(located.beads, range.number(index));
          motion.add(located);
          FrameReport report(located);
          for (const auto& [why, count] : report.dropped) left_out[why] += count;
          reports.push_back(std::move(report));
        },
        progress);
    return configuration;
  });
  imaging::check_flat(request.flat, found.locator.preprocess.bright);

  py::dict report;
  report["settings"] = settings_of(found.locator, request, said_frames);
  report["settings_frame"] = found.frame;
  report["contrast"] = found.locator.preprocess.contrast;
  report["picture_size"] = py::make_tuple(seen.whole_size().width, seen.whole_size().height);
  report["left_out"] = in_words(left_out);
  report["frames"] = per_frame(reports, range, motion);
  return py::make_tuple(columns_of(std::move(beads)), report);
}

struct TrackCall {
  calibration::FilmOptions film;
  std::optional<std::filesystem::path> output;
  imaging::LocatedTableOptions table;
};

/// Whether a stack is a table of located beads: a mapping of columns, such as a DataFrame, or the name of a
/// CSV file.
bool is_table(const py::object& stack) {
  if (py::hasattr(stack, "keys")) return true;
  return (py::isinstance<py::str>(stack) || py::hasattr(stack, "__fspath__")) &&
         imaging::is_located_table(stack.cast<std::filesystem::path>());
}

py::object track(const py::object& said, TrackCall call, const py::object& callback) {
  const py::object stack = stack_of_frames(said, call.film.locating.frames);
  std::string name;
  std::optional<Table> table;
  if (is_table(stack)) {
    table = table_of(stack);
    if (!py::hasattr(stack, "keys")) name = table->file;
    // The table of `locate` states the size of its pictures.
    if (!call.table.picture && py::hasattr(stack, "attrs") && stack.attr("attrs").contains("picture_size"))
      call.table.picture = stack.attr("attrs")["picture_size"].cast<std::array<int, 2>>();
  } else {
    source_of(stack, name);  // for the name, and so that a stack that cannot be opened is refused first
  }
  if (call.output) {
    const std::filesystem::path parent = call.output->parent_path();
    call.film.folder = parent.empty() ? "." : parent;
  }
  struct Forwarded : Progress {
    explicit Forwarded(Progress& to) : to_(to) {}
    void update(std::int64_t done, std::int64_t total) override { to_.update(done, total); }
    Progress& to_;
  };
  calibration::TrackedFilm film = unlocked(callback, [&](Progress& progress) {
    if (table)
      return calibration::track_table(*table, call.table, call.film, [&](const std::string&) {
        return std::make_unique<Forwarded>(progress);
      });
    return calibration::track_film(
        [&](const imaging::LocatorOptions& locator) {
          const py::gil_scoped_acquire lock;
          return prepared_stack(stack, call.film.locating, locator);
        },
        name, call.film, [&](const std::string&) { return std::make_unique<Forwarded>(progress); });
  });
  Provenance provenance = provenance_of("twincell.track (Python)", call.film.threads);
  provenance.config = film.cell.text;
  if (!name.empty()) provenance.inputs.push_back(imaging::file_of_stack(name));
  film.plan.info.provenance_json = provenance.to_json();
  std::shared_ptr<Trajectory> trajectory;
  std::vector<std::string> doubts;
  const auto write = [&](TrajectorySink& sink) {
    imaging::BedInCell watched(sink, film.plan.info, film.cell, film.stack.width_px, film.stack.height_px);
    imaging::write_trajectory(film.stack, film.plan, watched);
    doubts = watched.doubts();
  };
  if (call.output) {
    H5mdWriter writer(*call.output, film.plan.info);
    write(writer);
    writer.finish();
    trajectory = std::make_shared<Trajectory>(*call.output);
  } else {
    SharedFrames memory(film.plan.info);
    write(memory);
    trajectory = std::make_shared<Trajectory>(std::move(memory));
  }
  for (const std::string& doubt : doubts) warn(doubt);
  if (!film.stack.spacing_doubt.empty()) warn(film.stack.spacing_doubt);
  for (const std::string& doubt : film.stack.doubts(film.cell)) warn(doubt);
  if (!film.check.disagreement.empty())
    warn("the stated drive does not fit the film: " + film.check.disagreement + ".");
  return py::cast(trajectory);
}

/// Number of the track of each bead of a table, and whether its link is ambiguous, in the order of the
/// frames.
py::tuple link(const py::object& said, std::optional<double> search_range_px, int memory,
               std::optional<double> diameter, const std::map<std::string, std::string>& columns,
               const py::object& callback) {
  if (diameter) require_range({.file = {}, .key = "diameter"}, *diameter, 0, std::nullopt, true);
  imaging::LocatedTable beads =
      imaging::read_located(table_of(said), {.columns = columns, .diameter_px = diameter, .picture = {}}, {});
  imaging::LinkOptions options;
  options.memory = memory;
  if (search_range_px) {
    constexpr double kMostDiameters = 10;  // LinkOptions::range_diameters
    require_range({.file = {}, .key = "search_range"}, *search_range_px, 0,
                  kMostDiameters * beads.diameter_px, true);
    options.range_diameters = *search_range_px / beads.diameter_px;
  }
  const imaging::CellDescription anywhere;
  const imaging::TrackedStack stack = unlocked(callback, [&](Progress& progress) {
    return imaging::track_located(std::move(beads), options, anywhere, {}, {}, progress);
  });
  if (!stack.spacing_doubt.empty()) warn(stack.spacing_doubt);
  for (const std::string& doubt : stack.doubts(anywhere)) warn(doubt);
  std::vector<std::int64_t> particle;
  std::vector<std::uint8_t> ambiguous;
  for (std::size_t f = 0; f < stack.frames.size(); ++f)
    for (const imaging::TrackedBead& bead : stack.frames[f]) {
      particle.push_back(bead.track);
      ambiguous.push_back(bead.ambiguous ? 1 : 0);
    }
  return py::make_tuple(array_of(std::move(particle)), array_of(std::move(ambiguous)).attr("astype")("bool"));
}

void bind_link(py::module_& module) {
  module.def("link", &link, py::arg("beads"), py::kw_only(), py::arg("search_range") = py::none(),
             py::arg("memory") = imaging::LinkOptions{}.memory, py::arg("diameter") = py::none(),
             py::arg("columns") = std::map<std::string, std::string>{}, py::arg("callback") = py::none(),
             header_text("imaging/track/located_table.hpp", "track_located"));
}

void bind_locate(py::module_& module) {
  const imaging::LocatorOptions locator;
  module.def(
      "locate",
      [](const py::object& stack, const py::object& diameter, const std::string& finder, double min_score,
         double min_explained, const std::string& refine, bool bright, bool dark, const std::string& flat,
         const std::string& background, const std::string& roi, const std::string& mask,
         const std::string& frames, int threads, const py::object& callback) {
        return locate_beads_of(stack,
                               locating_request(diameter, finder, min_score, min_explained, refine, bright,
                                                dark, flat, background, roi, mask, frames),
                               threads, callback);
      },
      py::arg("stack"), py::arg("diameter") = py::none(), py::kw_only(), py::arg("locator") = locator.finder,
      py::arg("min_score") = locator.find.min_score, py::arg("min_explained") = locator.judge.min_score,
      py::arg("refine") = locator.refine.method, py::arg("bright") = false, py::arg("dark") = false,
      py::arg("flat") = "", py::arg("background") = "", py::arg("roi") = "", py::arg("mask") = "",
      py::arg("frames") = "", py::arg("threads") = 0, py::arg("callback") = py::none(),
      header_text("imaging/track/locate_stack.hpp", "locate_stack"));
}

void bind_track(py::module_& module) {
  const imaging::LocatorOptions locator;
  const imaging::LinkOptions link;
  module.def(
      "track",
      [](const py::object& stack, const std::optional<std::filesystem::path>& output,
         const std::optional<std::filesystem::path>& cell, std::optional<double> pixels_per_sigma,
         const std::optional<std::array<double, 2>>& origin_px, const py::object& set,
         std::optional<double> cell_width, std::optional<double> cell_height,
         std::optional<int> frames_per_cycle, const py::object& phase_lock, std::optional<double> drive_hz,
         std::optional<int> first_phase, std::optional<double> drive_gamma,
         std::optional<double> drive_amplitude, const py::object& diameter, const std::string& finder,
         double min_score, double min_explained, const std::string& refine, bool bright, bool dark,
         const std::string& flat, const std::string& background, const std::string& roi,
         const std::string& mask, const std::string& frames, double range, int memory,
         bool trust_stated_drive, int shortest, const std::map<std::string, std::string>& columns,
         const std::optional<std::array<int, 2>>& picture_size, int threads, const py::object& callback) {
        TrackCall call;
        call.table = {.columns = columns, .diameter_px = {}, .picture = picture_size};
        call.output = output;
        call.film.request = {
            .cell_file = cell ? cell->string() : std::string(),
            // As in simulate: a dict, or a list of "section.key=value".
            .assignments = py::module_::import("twincell._scenes")
                               .attr("assignments")(set)
                               .cast<std::vector<std::string>>(),
            .pixels_per_sigma = pixels_per_sigma,
            .origin = origin_px,
            .width = cell_width,
            .height = cell_height,
            .gamma = drive_gamma,
            .amplitude = drive_amplitude,
            .frames_per_cycle = frames_per_cycle,
            .first_phase = first_phase,
            .phase = {.phase_lock = phase_lock.is_none() ? "" : py::str(phase_lock).cast<std::string>(),
                      .drive_hz = drive_hz}};
        call.film.locating = locating_request(diameter, finder, min_score, min_explained, refine, bright,
                                              dark, flat, background, roi, mask, frames);
        call.film.link.range_diameters = range;
        call.film.link.memory = memory;
        require_range({.file = {}, .key = "shortest"}, shortest, 1, std::nullopt);
        call.film.shortest = shortest;
        call.film.trust_stated_drive = trust_stated_drive;
        call.film.threads = threads_of(threads);
        return track(stack, std::move(call), callback);
      },
      py::arg("stack"), py::arg("output") = py::none(), py::kw_only(), py::arg("cell") = py::none(),
      py::arg("pixels_per_sigma") = py::none(), py::arg("origin_px") = py::none(),
      py::arg("set") = py::tuple(), py::arg("cell_width") = py::none(), py::arg("cell_height") = py::none(),
      py::arg("frames_per_cycle") = py::none(), py::arg("phase_lock") = py::none(),
      py::arg("drive_hz") = py::none(), py::arg("first_phase") = py::none(),
      py::arg("drive_gamma") = py::none(), py::arg("drive_amplitude") = py::none(),
      py::arg("diameter") = py::none(), py::arg("locator") = locator.finder,
      py::arg("min_score") = locator.find.min_score, py::arg("min_explained") = locator.judge.min_score,
      py::arg("refine") = locator.refine.method, py::arg("bright") = false, py::arg("dark") = false,
      py::arg("flat") = "", py::arg("background") = "", py::arg("roi") = "", py::arg("mask") = "",
      py::arg("frames") = "", py::arg("range") = link.range_diameters, py::arg("memory") = link.memory,
      py::arg("trust_stated_drive") = false, py::arg("shortest") = 1,
      py::arg("columns") = std::map<std::string, std::string>{}, py::arg("picture_size") = py::none(),
      py::arg("threads") = 0, py::arg("callback") = py::none(),
      (summary_text("calibration/film/track_film.hpp", "track_film") +
       "\n\nstack: as for `locate`; or a table of located beads, a DataFrame or the name of a CSV file, with "
       "columns frame, x, y and optionally radius or diameter, sigma_x, sigma_y, tracer. output: H5MD file "
       "to write; "
       "None: in memory. cell: CELL.toml with scale, origin, size and drive of the cell; set: its keys, a "
       "dict; "
       "pixels_per_sigma, origin_px, cell_width, cell_height, drive_gamma, drive_amplitude, "
       "frames_per_cycle, "
       "first_phase, phase_lock and drive_hz state the same without a file. diameter to frames: as for "
       "`locate`. "
       "range: largest distance of a bead from its predicted position, bead diameters; memory: frames for "
       "which a bead "
       "may be missing; shortest: frames of the shortest track that is kept. trust_stated_drive: do not "
       "check the drive "
       "against the film. columns: names of columns of a table that are called otherwise, {\"x\": \"X\"}. "
       "picture_size: width and height of its frames, px. Options as those of `twincell track` "
       "(docs/tracking.md).")
          .c_str());
}

}  // namespace

void bind_locating(py::module_& module) {
  bind_locate(module);
  bind_link(module);
  bind_track(module);
}

}  // namespace twincell::python
