#pragma once
/// Figures drawn by gnuplot. Script and data stay beside each figure, so that users can restyle it.

#include <filesystem>
#include <string>
#include <vector>

namespace talus {

/// Runs a gnuplot script in its own folder, so that scripts name files without folders and the folder can be moved. False
/// if gnuplot is not installed; throws std::runtime_error with its message if the script fails.
bool run_gnuplot(const std::filesystem::path& script);

bool gnuplot_is_installed();

/// A folder beside a picture for the script and the data that draw it; it is removed with them in the end.
class DrawingFolder {
 public:
  explicit DrawingFolder(const std::filesystem::path& picture);
  ~DrawingFolder();
  DrawingFolder(const DrawingFolder&) = delete;
  DrawingFolder& operator=(const DrawingFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Colours from dark to bright that can be distinguished equally well along the whole scale, also in grey (viridis,
/// sampled), as a gnuplot palette.
std::string even_palette();

/// Colours of lines that remain distinct for the colour-blind (Okabe and Ito 2008).
const char* line_colour(int i);

/// One curve of a chart: a column of a CSV file against another, both counted from 1, scaled for display.
struct Curve {
  int column;
  std::string label;
};
struct Chart {
  std::string name;  ///< of the files: NAME.svg, NAME.gp
  std::string caption;
  std::string x_label, y_label;
  double x_scale = 1, y_scale = 1;
  int x_column = 1;
  std::vector<Curve> curves;
  std::string csv = "history.csv";  ///< where the columns are, in the folder of results
};

/// Draws columns of a CSV file as NAME.svg in `folder`. False if there is no gnuplot.
bool draw_chart(const std::filesystem::path& folder, const std::filesystem::path& csv, const Chart& chart);

/// A text inside single quotes of a gnuplot script.
std::string gnuplot_text(const std::string& text);

}  // namespace talus
