// The report.html of each command, made from the files in its result folder and nothing else.
#pragma once

#include <filesystem>

namespace flextip::report {

/// Makes FOLDER/report.html again, of whatever command summary.json names. Throws InputError where
/// the folder is no result, its command has no page, or a file that the page stands on is missing.
void WriteReport(const std::filesystem::path& folder);

// Each reads FOLDER/summary.json and what else is there (docs/formats.md), and writes
// FOLDER/report.html. What is absent is left out. They throw InputError where a file that is there
// cannot be read and WorkError where the page cannot be written.

/// The streams of a simulated arm with joints over time.
void WriteArmMotionReport(const std::filesystem::path& folder);
/// Per controller: deviation over time and the tip's path against the desired one, from
/// FOLDER/deviation.csv (one run) or FOLDER/CONTROLLER/deviation.csv (several); frames of cam0.
void WriteSimulateReport(const std::filesystem::path& folder);
/// Overlays; the tip's path, movement and covariance from vision0/data.csv; error, noise and tags
/// of each frame from frames.csv. Long tables are thinned, keeping least and greatest values.
void WriteTrackReport(const std::filesystem::path& folder);
/// Every column of state0/data.csv over time.
void WriteEstimateReport(const std::filesystem::path& folder);
/// What stopped it, from the excerpts in FOLDER/stops; the tip and its goal from
/// session0/cycles.csv; the times of the cycles from figures.json.
void WriteControlReport(const std::filesystem::path& folder);
/// A stop's sentence and picture, from the summary and stop.csv of an excerpt.
void WriteExcerptReport(const std::filesystem::path& folder);
/// What is wrong and what is doubtful, each with its mend; the streams.
void WriteCheckReport(const std::filesystem::path& folder);
/// The picture of a shape, or the table shapes.csv of a batch.
void WriteShapeReport(const std::filesystem::path& folder);
/// Overlays of the detected tags.
void WriteDetectReport(const std::filesystem::path& folder);
/// The verdict with what was found, what was not and what to do next; figures, pictures and
/// residuals.csv of a calibration.
void WriteCalibrateReport(const std::filesystem::path& folder);
/// The verdict, its evidence and the gain, from diagnosis.json (which must be there) and
/// residuals.csv.
void WriteDiagnoseReport(const std::filesystem::path& folder);
/// The error of both models by channel, from summary.json and residuals.csv.
void WritePredictReport(const std::filesystem::path& folder);
/// Every row of table.csv by chapter, and the figures of figures.json.
void WriteReproduceReport(const std::filesystem::path& folder);
/// The figures of figures.json (which must be there) and table.csv.
void WriteMapReport(const std::filesystem::path& folder);
/// The numbers of several runs side by side, and figures.json (which must be there).
void WriteCompareReport(const std::filesystem::path& folder);
/// Items that failed, the spread of the numbers and every item, from table.csv and figures.json
/// (which must be there).
void WriteBatchReport(const std::filesystem::path& folder);
/// What was assumed, and every stream over time.
void WriteImportReport(const std::filesystem::path& folder);

}  // namespace flextip::report
