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
    throw InputError(fmt::format("{} belongs to other data or settings; --overwrite starts again", file.string()));
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

namespace {

/// A calibration in progress: what it computes with, and what it reports.
class CalibrationRun {
 public:
  CalibrationRun(const Calibration& calibration, Backend& loop, CalibrationState& state,
                 const CalibrationObserver& observer)
      : calibration_(calibration),
        loop_(loop),
        state_(state),
        observer_(observer),
        clock_(state.seconds),
        evaluations_before_(state.evaluations),
        residuals_(calibration, loop),
        passes_(passes_of(calibration)),
        price_(price_of(calibration)) {}

  /// Finishes all starts. False if the observer stopped it, here and below.
  bool search_all_starts();
  /// The result at the best of the finished starts.
  std::optional<CalibrationResult> result();

 private:
  /// The passes of the present start that are left. Returns the evaluations they took; none if stopped.
  std::optional<int> search_passes();
  bool compute_statistics(CalibrationResult& result, const Evaluation& here);
  void leave_out_each_group(CalibrationResult& result, const Evaluation& here, const std::vector<Matrix>& jacobian);
  void predict_tests(CalibrationResult& result);

  bool stopped() const { return observer_.stop && observer_.stop(); }
  long evaluations() const { return evaluations_before_ + residuals_.n_evaluations(); }
  double objective_at(const Evaluation& e) const {
    return objective(calibration_, sum_of_squares(e, all_rows(calibration_)));
  }
  void save();
  void show(const std::string& where, double misfit) const;

  const Calibration& calibration_;
  Backend& loop_;
  CalibrationState& state_;
  const CalibrationObserver& observer_;
  Clock clock_;
  long evaluations_before_;
  Residuals residuals_;
  std::vector<Pass> passes_;
  Price price_;
};

void CalibrationRun::save() {
  state_.fingerprint = calibration_.fingerprint;
  state_.seconds = clock_.seconds();
  state_.evaluations = evaluations();
  if (observer_.save) observer_.save(state_);
}

void CalibrationRun::show(const std::string& where, double misfit) const {
  if (!observer_.progress) return;
  const double left = double(std::max(1l, price_.of_searches + price_.of_leave_one_out - evaluations()));
  observer_.progress(where, misfit, evaluations(), left * clock_.seconds() / double(std::max(1l, evaluations())));
}

std::optional<int> CalibrationRun::search_passes() {
  int n = 0;
  for (; state_.pass < int(passes_.size()); ++state_.pass, state_.search = SearchState{state_.search.x}) {
    const Pass& pass = passes_[std::size_t(state_.pass)];
    bool interrupted = false;
    search(residuals_, pass.parameters, pass.rows, state_.search, [&](const SearchState& s, double sum) {
      save();
      show(fmt::format("start {} of {}, {}, iteration {}", state_.finished.size() + 1, state_.starts.size(), pass.name,
                       s.iteration),
           std::sqrt(objective(calibration_, sum)));
      interrupted = stopped();
      return !interrupted;
    });
    if (interrupted) return std::nullopt;
    n += state_.search.evaluations;
  }
  return n;
}

bool CalibrationRun::search_all_starts() {
  if (state_.starts.empty()) {
    state_.starts = draw_starts(residuals_);
    state_.search = {state_.starts[0]};
    save();
  }
  while (state_.finished.size() < state_.starts.size()) {
    const std::optional<int> n = search_passes();
    if (!n) return false;
    const Vector& from = state_.starts[state_.finished.size()];
    const double reached = objective_at(residuals_.at(state_.search.x));
    state_.finished.push_back({from, state_.search.x, reached, *n});
    state_.pass = 0;
    if (state_.finished.size() < state_.starts.size()) state_.search = {state_.starts[state_.finished.size()]};
    save();
  }
  return true;
}

void CalibrationRun::leave_out_each_group(CalibrationResult& result, const Evaluation& here,
                                          const std::vector<Matrix>& jacobian) {
  show("leaving out each test", std::sqrt(result.objective));
  result.left_out = leave_one_out(residuals_, result.x, here, jacobian);
  result.jackknife = jackknife_errors(result.left_out);
  for (Eigen::Index p = 0; p < result.x.size(); ++p)
    result.jackknife[p] *= std::abs(slope_of(calibration_.free[std::size_t(p)], result.x[p]));
}

bool CalibrationRun::compute_statistics(CalibrationResult& result, const Evaluation& here) {
  show("standard errors", std::sqrt(result.objective));
  const std::vector<Matrix> jacobian = residuals_.jacobian(result.x, here, passes_.back().parameters, true);
  result.statistics = statistics_at(calibration_, result.x, here, jacobian);
  result.findings = findings_of(calibration_, result.statistics);
  if (stopped()) return false;
  if (calibration_.settings.leave_one_out && groups_of(calibration_).size() > 1)
    leave_out_each_group(result, here, jacobian);
  if (stopped()) return false;
  if (calibration_.settings.suggest_tests) {
    show("which further test would help", std::sqrt(result.objective));
    result.suggestions = suggest_tests(residuals_, result.x, result.statistics);
  }
  return true;
}

void CalibrationRun::predict_tests(CalibrationResult& result) {
  result.tests.resize(calibration_.tests.size());
  const AnyLaw first = law_at(calibration_, start_of_material(calibration_));
  loop_.for_each(int(calibration_.tests.size()), [&](int i, int) {
    const MeasuredTest& test = calibration_.tests[std::size_t(i)];
    TestResult& one = result.tests[std::size_t(i)];
    one.start = predict(test, first, calibration_.settings.precision);
    one.fitted = predict(test, result.law, calibration_.settings.precision);
    one.misfits_start = misfits_of(test, one.start);
    one.misfits_fitted = misfits_of(test, one.fitted);
  });
}

std::optional<CalibrationResult> CalibrationRun::result() {
  CalibrationResult result;
  result.starts = state_.finished;
  for (std::size_t i = 1; i < result.starts.size(); ++i)
    if (result.starts[i].objective < result.starts[result.best].objective) result.best = i;
  result.x = result.starts[result.best].x;
  result.law = law_at(calibration_, result.x);
  const Evaluation start = residuals_.at(start_of_material(calibration_)), here = residuals_.at(result.x);
  result.objective_start = objective_at(start);
  result.objective = objective_at(here);
  if (!compute_statistics(result, here)) return std::nullopt;
  predict_tests(result);
  result.evaluations = evaluations();
  result.seconds = clock_.seconds();
  result.threads = loop_.n_workers();
  return result;
}

}  // namespace

std::optional<CalibrationResult> calibrate(const Calibration& calibration, Backend& loop, CalibrationState& state,
                                           const CalibrationObserver& observer) {
  CalibrationRun run(calibration, loop, state, observer);
  if (!run.search_all_starts()) return std::nullopt;
  return run.result();
}

}  // namespace talus
