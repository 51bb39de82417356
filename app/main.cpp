#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "app/commands.hpp"
#include "app/machine.hpp"
#include "core/error.hpp"
#include "core/version.hpp"

namespace {

constexpr const char* introduction = R"(corpuscle simulates dense suspensions of deformable cells (red blood cells, capsules) in shear flow:
lattice Boltzmann fluid, immersed boundary coupling, finite element membranes.

Start here:
  corpuscle plan scenes/quickstart.toml                      what would run, how long, how much memory
  corpuscle run  scenes/quickstart.toml --output results/a   run it; Ctrl-C stops cleanly, all data are kept
  corpuscle resume results/a                                 go on where it was stopped or killed
  corpuscle analyse results/a                                viscosity, fluctuations, diffusion, shapes ... with errors
  corpuscle run  scenes/quickstart.toml --output results/b --set flow.capillary_number=0.02 --set run.strain=5
  corpuscle sweep flow_curve.toml --output results/curve     a matrix of scenes (docs/sweep.md)
  corpuscle tradeoff study.toml --output results/study       error against cost over settings of accuracy (docs/tradeoff.md))";

constexpr const char* ending = R"(A scene is a small TOML file, all keys are in docs/scene.md; what a run writes is in docs/outputs.md.
Exit codes: 0 done, 1 unexpected error, failed output or a failed run of a sweep, 2 bad input (nothing was written), 3 the simulation became
unstable, 75 stopped by --wall-time or SIGUSR1 (resume goes on), 130 stopped by Ctrl-C or SIGTERM (resume goes on).)";

void add_scene_options(CLI::App& command, corpuscle::app::SceneOptions& options) {
  command.add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  command.add_option("--set", options.overrides, "Override a key of the scene, for example --set cells.0.count=10 (may be repeated)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--threads", options.threads, "Number of host threads (default: OMP_NUM_THREADS, else all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
}

CLI::Option* add_sweep_options(CLI::App& command, corpuscle::app::SweepOptions& options) {
  command.add_option("-o,--output", options.output, "Directory for all runs; created")->type_name("DIR")->required();
  command.add_flag("--dry-run", options.dry_run, "Print all points with cells, nodes, steps, memory and time; writes nothing");
  command.add_option("--jobs", options.jobs, "Runs at a time (default: as many as cores and memory allow)")->type_name("N")->check(CLI::Range(1, 4096));
  command.add_option("--threads", options.threads, "Host threads of each run (default: by its number of nodes)")->type_name("N")->check(CLI::Range(1, 4096));
  command.add_option("--wall-time", options.wall_time, "Stop all runs with checkpoints after this time, counted from the start of the program (exit code 75)")->type_name("HH:MM:SS");
  return command.add_flag("--job-array", options.job_array, "Run nothing; write DIR/job_array.sh, a Slurm job array with a task for each point")->excludes("--dry-run");
}

int fail(int code, const char* message) {
  std::fprintf(stderr, "error: %s\n", message);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace corpuscle;
  app::return_freed_memory();
  CLI::App program{introduction, "corpuscle"};
  program.footer(ending);
  program.set_version_flag("--version", "corpuscle " + version_string() + " (" + git_revision() + ")");
  program.require_subcommand(1);

  app::PlanOptions plan_options;
  auto* plan = program.add_subcommand("plan", "Show lattice parameters, stability limits, memory and time of a scene; writes nothing");
  add_scene_options(*plan, plan_options);
  plan->add_flag("--json", plan_options.json, "Machine-readable output");

  app::RunOptions run_options;
  auto* run = program.add_subcommand("run", "Run a scene and write its results into a directory");
  add_scene_options(*run, run_options);
  run->add_option("-o,--output", run_options.output, "Directory for the results; created")->type_name("DIR")->required();
  run->add_flag("--overwrite", run_options.overwrite, "Replace the results of an earlier run in that directory");
  run->add_flag("--profile", run_options.profile, "Print the time of each operator at the end, and write it into summary.json");

  constexpr const char* about_wall_time = "Stop with a checkpoint after this time, counted from the start of the program (exit code 75)";
  run->add_option("--wall-time", run_options.wall_time, about_wall_time)->type_name("HH:MM:SS");

  app::ResumeOptions resume_options;
  auto* resume = program.add_subcommand("resume", "Go on with a run that was stopped or killed, or make a finished one longer; the same bits as if it had never stopped");
  resume->add_option("DIR", resume_options.directory, "Directory of the run")->required();
  resume->add_option("--until", resume_options.until, "New length of the run: strain=X, steps=N or duration=X (default: that of the scene)")->type_name("KEY=VALUE");
  resume->add_option("--wall-time", resume_options.wall_time, about_wall_time)->type_name("HH:MM:SS");
  resume->add_option("--set", resume_options.overrides, "Another limit of a guard or cadence of checkpoints: guards.KEY=VALUE, output.checkpoint_every=VALUE ...")
      ->type_name("KEY=VALUE");
  resume->add_option("--precision", resume_options.precision, "Go on with the fluid in single or double precision (default: as before)")
      ->check(CLI::IsMember({"single", "double"}));
  resume->add_option("--threads", resume_options.threads, "Number of host threads (default: OMP_NUM_THREADS, else all cores)")->type_name("N")->check(CLI::Range(1, 4096));
  resume->add_flag("--profile", resume_options.profile, "Print the time of each operator at the end, and write it into summary.json");

  app::SweepOptions sweep_options;
  auto* sweep = program.add_subcommand("sweep", "Run a matrix of scenes side by side (docs/sweep.md); the same command goes on where it was stopped or killed, and runs points that were added");
  sweep->add_option("SWEEP", sweep_options.sweep, "Sweep file (TOML): a base scene and the values that vary")->required();
  add_sweep_options(*sweep, sweep_options);

  app::TradeoffOptions tradeoff_options;
  auto* tradeoff = program.add_subcommand("tradeoff", "Run a scene over settings of accuracy and report error against cost: the front, what each knob buys (docs/tradeoff.md); goes on where it was stopped");
  tradeoff->add_option("STUDY", tradeoff_options.sweep, "Study file (TOML): a sweep with a table [study]")->required();
  auto* tradeoff_job_array = add_sweep_options(*tradeoff, tradeoff_options);
  tradeoff->add_flag("--no-run", tradeoff_options.no_run, "Run nothing, compare the runs that are there")->excludes("--dry-run")->excludes(tradeoff_job_array)->excludes("--jobs")->excludes("--wall-time");

  app::CheckOptions check_options;
  auto* check = program.add_subcommand("check", "Verify the results in a directory, of a finished, broken or running run: 0 all is well, 1 problems, 2 not results of a run");
  check->add_option("DIR", check_options.directory, "Directory that run wrote")->required();
  check->add_flag("--json", check_options.json, "Machine-readable output");
  check->add_flag("--recover", check_options.recover, "First finish, or take back, what a killed run was writing; without it check changes nothing");

  app::AnalyseOptions analyse_options;
  auto* analyse = program.add_subcommand("analyse", "Compute all observables of a finished or running run, with errors, into analysis.json and analysis.md (docs/analysis.md)");
  analyse->add_option("DIR", analyse_options.directory, "Directory that run wrote")->required();
  analyse->add_option("--wall-layer", analyse_options.wall_layer, "Thickness of the layers at both walls that are no bulk")->type_name("RADII")->capture_default_str();
  analyse->add_option("--mean-flow", analyse_options.mean_flow, "Flow that velocity fluctuations along x are about: measured in layers of z, or uniform shear")
      ->check(CLI::IsMember({"measured", "uniform"}))
      ->capture_default_str();
  analyse->add_option("--shear-rate", analyse_options.shear_rate, "Rate that strains, velocities, stresses and Ca are referred to: of the walls, or the measured one of the bulk")
      ->check(CLI::IsMember({"walls", "bulk"}))
      ->capture_default_str();
  analyse->add_option("--discard", analyse_options.discard, "Leave the start-up up to this strain out (default: found from the series)")->type_name("STRAIN");
  analyse->add_option("--longest-lag", analyse_options.longest_lag, "Longest lag of time correlations (default: a quarter of what is left)")->type_name("STRAIN");
  analyse->add_option("-o,--output", analyse_options.output, "File of the results (default: analysis.json in DIR); the page goes beside it, with .md")->type_name("FILE");

  app::StabilityOptions stability_options;
  auto* stability = program.add_subcommand("stability", "Search for the stability limits that plan and run use (docs/stability.md); an interrupted search goes on where it stopped");
  stability->add_option("-o,--output", stability_options.output, "Directory of the results, stability.json (default: results/stability)")->type_name("DIR");
  stability->add_option("--only", stability_options.only, "Parameters to search, separated by commas (default: all)")->type_name("PARAMETER")->delimiter(',');
  stability->add_option("--conditions", stability_options.conditions, "Only cases whose conditions contain this text, for example \"in flow, 3 points\"")->type_name("TEXT");
  stability->add_option("--threads", stability_options.threads, "Number of host threads (default: OMP_NUM_THREADS, else all cores)")->type_name("N")->check(CLI::Range(1, 4096));

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    return fail(exit_code::bad_input, (std::string(error.what()) + "; see corpuscle --help").c_str());
  }
  try {
    if (*check) return app::check(check_options);
    if (*analyse) return app::analyse(analyse_options);
    if (*stability) return app::stability(stability_options);
    if (*resume) return app::resume(resume_options);
    if (*sweep) return app::sweep(sweep_options);
    if (*tradeoff) return app::tradeoff(tradeoff_options);
    return *plan ? app::plan(plan_options) : app::run(run_options);
  } catch (const InputError& error) {
    return fail(exit_code::bad_input, error.what());
  } catch (const SimulationError& error) {
    return fail(exit_code::broken_run, error.what());
  } catch (const std::bad_alloc&) {
    return fail(exit_code::bad_input, "The scene needs more memory than this machine has (corpuscle plan tells how much): reduce box.size or accuracy.radius.");
  } catch (const std::exception& error) {
    return fail(exit_code::failure, error.what());
  }
}
