#pragma once
/// \file
/// Declarations of the verbs. Each verb has its own file NAME.cpp with its options struct, its set-up
/// function `add_NAME` and the function that it runs. To add a verb, write that file, add a line here and add
/// a line to the table in main.cpp.

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// Adds a verb to `program`. The callback of the verb runs if the user selects the verb. It throws
/// twincell::Error on failure.
using AddVerb = void (*)(CLI::App& program, Common& common);

void add_analyze(CLI::App& program, Common& common);
void add_calibrate(CLI::App& program, Common& common);
void add_compare(CLI::App& program, Common& common);
void add_completion(CLI::App& program, Common& common);
void add_cost(CLI::App& program, Common& common);
void add_draw(CLI::App& program, Common& common);
void add_example(CLI::App& program, Common& common);
void add_explain(CLI::App& program, Common& common);
void add_export(CLI::App& program, Common& common);
void add_fit(CLI::App& program, Common& common);
void add_help(CLI::App& program, Common& common);
void add_import(CLI::App& program, Common& common);
void add_info(CLI::App& program, Common& common);
void add_keys(CLI::App& program, Common& common);
void add_locate(CLI::App& program, Common& common);
void add_man(CLI::App& program, Common& common);
void add_match(CLI::App& program, Common& common);
void add_measure(CLI::App& program, Common& common);
void add_new(CLI::App& program, Common& common);
void add_render(CLI::App& program, Common& common);
void add_reproduce(CLI::App& program, Common& common);
void add_simulate(CLI::App& program, Common& common);
void add_sweep(CLI::App& program, Common& common);
void add_track(CLI::App& program, Common& common);
void add_validate(CLI::App& program, Common& common);

}  // namespace twincell::cli
