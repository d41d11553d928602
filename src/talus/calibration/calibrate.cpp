#include "talus/calibration/calibrate.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "talus/base/error.hpp"
#include "talus/base/file.hpp"

namespace talus {

namespace {

using Json = nlohmann::ordered_json;

constexpr int usual_iterations = 6;
constexpr int candidates_per_start = 4;

std::vector<double> numbers_of(const Vector& v) { return {v.begin(), v.end()}; }
Vector vector_from(const Json& json) {
  const auto numbers = json.get<std::vector<double>>();
  return Eigen::Map<const Vector>(numbers.data(), Eigen::Index(numbers.size()));
}

Vector start_of_material(const Calibration& calibration) {
  Vector x(Eigen::Index(calibration.free.size()));
  for (std::size_t i = 0; i < calibration.free.size(); ++i)
    x[Eigen::Index(i)] = std::clamp(to_coordinate(calibration.free[i], calibration.free[i].start), 0.0, 1.0);
  return x;
}

/// The material's values, and the best of some points drawn inside the bounds. The same on every machine.
std::vector<Vector> draw_starts(Residuals& residuals) {
  const Calibration& calibration = residuals.calibration();
  std::vector<Vector> starts = {start_of_material(calibration)};
  const int n = calibration.settings.starts - 1;
  if (n == 0) return starts;
  std::mt19937_64 random(std::uint64_t(calibration.settings.seed));
  std::vector<Vector> candidates;
  const std::vector<double> void_ratios = void_ratios_of_tests(calibration);
  for (int tries = 0; tries < 100 * n && int(candidates.size()) < candidates_per_start * n; ++tries) {
    Vector x(starts[0].size());
    for (double& coordinate : x) coordinate = 0.05 + 0.9 * double(random() >> 11) * 0x1p-53;
    if (fault_of(law_at(calibration, x), void_ratios).empty()) candidates.push_back(x);
  }
  const RowMask mask = all_rows(calibration);
  std::vector<std::pair<double, std::size_t>> order;
  const std::vector<Evaluation> found = residuals.at(candidates);
  for (std::size_t i = 0; i < candidates.size(); ++i) order.emplace_back(sum_of_squares(found[i], mask), i);
  std::sort(order.begin(), order.end());
  for (int i = 0; i < std::min(n, int(order.size())); ++i) starts.push_back(candidates[order[std::size_t(i)].second]);
  return starts;
}

class Clock {
 public:
  explicit Clock(double before) : before_(before), start_(std::chrono::steady_clock::now()) {}
  double seconds() const {
    return before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double before_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

CalibrationState read_state(const std::filesystem::path& file, std::uint64_t fingerprint) {
  CalibrationState state;
  try {
    const Json json = Json::parse(contents_of(file));
    state.fingerprint = json.at("fingerprint").get<std::uint64_t>();
    for (const Json& s : json.at("starts")) state.starts.push_back(vector_from(s));
    for (const Json& f : json.at("finished"))
      state.finished.push_back({vector_from(f.at("from")), vector_from(f.at("x")), f.at("objective").get<double>(),
                                f.at("evaluations").get<int>()});
    state.pass = json.at("pass").get<int>();
    const Json& s = json.at("search");
    state.search = {vector_from(s.at("x")), s.at("damping").get<double>(), s.at("iteration").get<int>(),
                    s.at("evaluations").get<int>(), s.at("finished").get<bool>()};
    state.seconds = json.at("seconds").get<double>();
    state.evaluations = json.at("evaluations").get<long>();
  } catch (const std::exception& e) {
    throw InputError(fmt::format("{} holds no state of a calibration: {}", file.string(), e.what()));
  }
  if (state.fingerprint != fingerprint)
    throw InputError(fmt::format("{} belongs to other data or settings; --overwrite begins anew", file.string()));
  return state;
}

void write_state(const std::filesystem::path& file, const CalibrationState& state) {
  Json json;
  json["fingerprint"] = state.fingerprint;
  json["starts"] = Json::array();
  for (const Vector& s : state.starts) json["starts"].push_back(numbers_of(s));
  json["finished"] = Json::array();
  for (const FinishedStart& f : state.finished)
    json["finished"].push_back({{"from", numbers_of(f.from)},
                                {"x", numbers_of(f.x)},
                                {"objective", f.objective},
                                {"evaluations", f.evaluations}});
  json["pass"] = state.pass;
  json["search"] = {{"x", numbers_of(state.search.x)},
                    {"damping", state.search.damping},
                    {"iteration", state.search.iteration},
                    {"evaluations", state.search.evaluations},
                    {"finished", state.search.finished}};
  json["seconds"] = state.seconds;
  json["evaluations"] = state.evaluations;
  write_whole(file, json.dump(1) + "\n");
}

std::vector<Pass> passes_of(const Calibration& calibration) {
  std::vector<Pass> passes;
  std::vector<int> all;
  for (std::size_t p = 0; p < calibration.free.size(); ++p) all.push_back(int(p));
  if (calibration.settings.by_stages)
    for (int stage = 0; stage < n_stages; ++stage) {
      Pass pass{std::string(stage_choices[stage].word), {}, rows_of_stage(calibration, Stage(stage))};
      for (int p : all)
        if (calibration.free[std::size_t(p)].stage == Stage(stage)) pass.parameters.push_back(p);
      if (!pass.parameters.empty() && !is_empty(pass.rows)) passes.push_back(std::move(pass));
    }
  passes.push_back({"all parameters", all, all_rows(calibration)});
  return passes;
}

Price price_of(const Calibration& calibration) {
  Price price{0, 0};
  long of_start = 0;
  for (const Pass& pass : passes_of(calibration)) of_start += usual_iterations * (long(pass.parameters.size()) + 1);
  const int starts = calibration.settings.starts;
  price.of_searches = starts * of_start + (starts - 1) * candidates_per_start + 2 * long(calibration.free.size());
  const auto n = long(groups_of(calibration).size());
  if (calibration.settings.leave_one_out && n > 1) price.of_leave_one_out = 2 * n;
  return price;
}

std::optional<CalibrationResult> calibrate(const Calibration& calibration, Backend& loop, CalibrationState& state,
                                           const CalibrationObserver& observer) {
  const Clock clock(state.seconds);
  const long evaluations_before = state.evaluations;
  Residuals residuals(calibration, loop);
  const std::vector<Pass> passes = passes_of(calibration);
  const Price price = price_of(calibration);
  const auto stopped = [&] { return observer.stop && observer.stop(); };
  const auto save = [&] {
    state.fingerprint = calibration.fingerprint;
    state.seconds = clock.seconds();
    state.evaluations = evaluations_before + residuals.n_evaluations();
    if (observer.save) observer.save(state);
  };
  const auto show = [&](const std::string& where, double misfit) {
    if (!observer.progress) return;
    const long done = evaluations_before + residuals.n_evaluations();
    const double left = double(std::max(1l, price.of_searches + price.of_leave_one_out - done));
    observer.progress(where, misfit, done, left * clock.seconds() / double(std::max(1l, done)));
  };
  if (state.starts.empty()) {
    state.starts = draw_starts(residuals);
    state.search = {state.starts[0]};
    save();
  }
  while (state.finished.size() < state.starts.size()) {
    const std::size_t number = state.finished.size();
    int evaluations = 0;
    for (; state.pass < int(passes.size()); ++state.pass, state.search = SearchState{state.search.x}) {
      const Pass& pass = passes[std::size_t(state.pass)];
      bool interrupted = false;
      search(residuals, pass.parameters, pass.rows, state.search, [&](const SearchState& s, double sum) {
        save();
        show(fmt::format("start {} of {}, {}, iteration {}", number + 1, state.starts.size(), pass.name, s.iteration),
             std::sqrt(objective(calibration, sum)));
        interrupted = stopped();
        return !interrupted;
      });
      if (interrupted) return std::nullopt;
      evaluations += state.search.evaluations;
    }
    const double sum = sum_of_squares(residuals.at(state.search.x), all_rows(calibration));
    state.finished.push_back({state.starts[number], state.search.x, objective(calibration, sum), evaluations});
    state.pass = 0;
    if (state.finished.size() < state.starts.size()) state.search = {state.starts[state.finished.size()]};
    save();
  }

  CalibrationResult result;
  result.starts = state.finished;
  for (std::size_t i = 1; i < result.starts.size(); ++i)
    if (result.starts[i].objective < result.starts[result.best].objective) result.best = i;
  result.x = result.starts[result.best].x;
  result.law = law_at(calibration, result.x);
  const Evaluation start = residuals.at(start_of_material(calibration)), here = residuals.at(result.x);
  result.objective_start = objective(calibration, sum_of_squares(start, all_rows(calibration)));
  result.objective = objective(calibration, sum_of_squares(here, all_rows(calibration)));
  const double misfit = std::sqrt(result.objective);
  show("standard errors", misfit);
  const std::vector<Matrix> jacobian = residuals.jacobian(result.x, here, passes.back().parameters, true);
  result.statistics = statistics_at(calibration, result.x, here, jacobian);
  result.findings = findings_of(calibration, result.statistics);
  if (stopped()) return std::nullopt;
  if (calibration.settings.leave_one_out && groups_of(calibration).size() > 1) {
    show("leaving out each test", misfit);
    result.left_out = leave_one_out(residuals, result.x, here, jacobian);
    result.jackknife = jackknife_errors(result.left_out);
    for (Eigen::Index p = 0; p < result.x.size(); ++p)
      result.jackknife[p] *= std::abs(slope_of(calibration.free[std::size_t(p)], result.x[p]));
  }
  if (stopped()) return std::nullopt;
  if (calibration.settings.suggest_tests) {
    show("which further test would help", misfit);
    result.suggestions = suggest_tests(residuals, result.x, result.statistics);
  }
  result.tests.resize(calibration.tests.size());
  const AnyLaw first = law_at(calibration, start_of_material(calibration));
  loop.for_each(int(calibration.tests.size()), [&](int i, int) {
    const MeasuredTest& test = calibration.tests[std::size_t(i)];
    TestResult& one = result.tests[std::size_t(i)];
    one.start = predict(test, first, calibration.settings.precision);
    one.fitted = predict(test, result.law, calibration.settings.precision);
    one.misfits_start = misfits_of(test, one.start);
    one.misfits_fitted = misfits_of(test, one.fitted);
  });
  result.evaluations = evaluations_before + residuals.n_evaluations();
  result.seconds = clock.seconds();
  result.threads = loop.n_workers();
  return result;
}

}  // namespace talus
