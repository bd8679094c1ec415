#pragma once
/// \file
/// One verb, one file: NAME.cpp holds its options struct, `add_NAME` (set-up) and what it runs. A new verb is
/// that file, a line here and a line in main.cpp's table.

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// Adds the verb to `program`; its callback runs when the verb is chosen, and throws twincell::Error to fail.
using AddVerb = void (*)(CLI::App& program, Common& common);

void add_analyze(CLI::App& program, Common& common);
void add_calibrate(CLI::App& program, Common& common);
void add_compare(CLI::App& program, Common& common);
void add_cost(CLI::App& program, Common& common);
void add_explain(CLI::App& program, Common& common);
void add_export(CLI::App& program, Common& common);
void add_fit(CLI::App& program, Common& common);
void add_import(CLI::App& program, Common& common);
void add_info(CLI::App& program, Common& common);
void add_locate(CLI::App& program, Common& common);
void add_match(CLI::App& program, Common& common);
void add_measure(CLI::App& program, Common& common);
void add_render(CLI::App& program, Common& common);
void add_reproduce(CLI::App& program, Common& common);
void add_simulate(CLI::App& program, Common& common);
void add_sweep(CLI::App& program, Common& common);
void add_track(CLI::App& program, Common& common);
void add_validate(CLI::App& program, Common& common);

}  // namespace twincell::cli
