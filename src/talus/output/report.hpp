#pragma once
/// record.json and report.html: what was asked, what was done, what came out.

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "talus/input/read.hpp"
#include "talus/output/history.hpp"
#include "talus/output/picture.hpp"

namespace talus {

/// What is known of a run when it has ended.
struct RunSummary {
  std::string case_file;
  std::string case_text;  ///< the file as it was read
  std::vector<Understood> understood;
  Ledger ledger;
  StepTally tally;
  Outline start, end;
  double wall_seconds = 0, cpu_seconds = 0;
  long n_particles = 0;
  std::size_t bytes = 0;
  int n_threads = 1;
  int n_snapshots = 0;
  std::string failure;             ///< what broke the run; empty if nothing did
  bool stopped = false;            ///< by the user, before its end
  std::vector<double> resumed_at;  ///< times from which it was gone on with [s]
  std::vector<std::string> warnings;
};

/// What a scaled stiffness means for a run; nothing where it is not scaled.
std::string notice_of_stiffness(const Numerics& numerics);
/// What a case with a preset is, and where it departs from it; nothing for the standard one.
std::string notice_of_preset(const Case& what);

/// That planes of symmetry leave only a part of the whole to be computed; nothing if there are none.
std::string notice_of_symmetry(const Case& what);

/// What has left a run through sides that let out; nothing if nothing has.
std::string notice_of_outflow(const Ledger& ledger);

/// How long the steps were and what bounded them, in a sentence.
std::string in_words(const StepTally& tally);

/// Warnings that a run's numbers call for.
std::vector<std::string> warnings_of(const Case& what, const RunSummary& run);

/// Everything that is needed to know what was run, by which version, on what machine, and how it went.
void write_record(const std::filesystem::path& file, const RunSummary& run);

/// Whether a folder holds the results of this case, to the letter, and its record says that this very version finished
/// it.
bool is_finished(const std::filesystem::path& folder, const std::string& case_text);

/// Writes report.html, a page that opens without network and without other files, of the results in `folder`: particles
/// and curves come from particles.hdf.series (and failure.hdf) and history.csv there.
void write_report(const std::filesystem::path& folder, const Case& what, const RunSummary& run,
                  const std::vector<Picture>& pictures, const std::vector<Chart>& charts);

}  // namespace talus
