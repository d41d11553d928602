#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/text.hpp"
#include "talus/output/figure_page.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// The figures asked for, in the order of their names.
std::vector<fs::path> folders_of(const ReproduceOptions& options) {
  std::vector<fs::path> folders;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(options.from, failure))
    if (fs::exists(entry.path() / "figure.toml")) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  if (folders.empty())
    throw InputError(fmt::format("{} holds no folders with a figure.toml; name the folder with --from", options.from));
  if (options.figure == "all") return folders;
  std::vector<std::string> names;
  for (const fs::path& f : folders) {
    names.push_back(f.filename().string());
    if (names.back() == options.figure || names.back() == fmt::format("figure_{:0>2}", options.figure)) return {f};
  }
  const std::vector<std::string_view> words(names.begin(), names.end());
  const std::string_view alike = most_alike(options.figure, words);
  throw InputError(
      fmt::format("`{}` is no figure; {}", options.figure,
                  alike.empty() ? "there is all, " + any_of(words) : fmt::format("did you mean `{}`?", alike)));
}

}  // namespace

int reproduce(const ReproduceOptions& options) {
  std::vector<RemadeFigure> figures;
  std::vector<Complaint> complaints;
  for (const fs::path& folder : folders_of(options)) {
    try {
      figures.push_back({read_figure(folder.string()), {}, {}});
    } catch (const InputError& e) {
      complaints.insert(complaints.end(), e.complaints().begin(), e.complaints().end());
    }
  }
  if (!complaints.empty()) throw InputError(complaints);

  struct Run {
    RemadeFigure* figure;
    std::size_t reading, curve;
  };
  std::vector<Run> runs;
  for (RemadeFigure& f : figures) {
    f.runs.assign(f.spec.readings.size(), std::vector<std::optional<ElementResult>>(f.spec.curves.size()));
    for (std::size_t r = 0; r < f.spec.readings.size(); ++r)
      for (std::size_t c = 0; c < f.spec.curves.size(); ++c)
        if (f.spec.curves[c].tests[r]) runs.push_back({&f, r, c});
  }
  const auto loop = make_openmp(options.threads);
  fmt::print(stderr, "{} element tests in {} figure{} on {} thread{}\n", runs.size(), figures.size(),
             figures.size() == 1 ? "" : "s", loop->n_workers(), loop->n_workers() == 1 ? "" : "s");
  const auto start = std::chrono::steady_clock::now();
  loop->for_each(int(runs.size()), [&](int i, int) {
    const Run& run = runs[i];
    run.figure->runs[run.reading][run.curve] =
        run_element_test(run.figure->spec.curves[run.curve].tests[run.reading]->test);
  });
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  fmt::print(stderr, "done in {:.1f} s\n", taken.count());

  const fs::path out = options.out.empty() ? fs::path("out") / "reproduce" : fs::path(options.out);
  bool drawn = true;
  for (RemadeFigure& f : figures) {
    f.result = evaluate_figure(f.spec, f.runs);
    drawn = write_figure(out / f.spec.name, f) && drawn;
    int hold = 0, elsewhere = 0, unchecked = 0;
    for (const Statement& s : f.spec.statements) unchecked += s.number.empty();
    for (const Verdict& v : f.result.verdicts) {
      hold += v.in_first();
      elsewhere += !v.in_first() && v.in_another();
    }
    fmt::print("{:<24} {:>3} of {} claims hold{}\n", f.spec.name, hold, f.result.verdicts.size(),
               (elsewhere > 0 ? fmt::format(", {} more in another reading", elsewhere) : "") +
                   (unchecked > 0 ? fmt::format(", {} cannot be checked", unchecked) : ""));
  }
  if (!drawn) fmt::print(stderr, "warning: no pictures were drawn; gnuplot is not installed\n");
  write_figure_index(out / "index.html", figures);
  fmt::print("index:  {}\n", fs::absolute(out / "index.html").string());
  return 0;
}

}  // namespace talus
