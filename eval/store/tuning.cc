#include "eval/store/tuning.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <stdexcept>

#include "controller/config/json.h"
#include "eval/store/database.h"
#include "eval/store/machine.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

using tune::SearchStatus;

Table<TuneSearchRecord> searches(SQLite::Database& db) { return {db, "tune_search", {"id"}}; }

/// The rows of one search, in order.
template <class R>
Table<R> parts(SQLite::Database& db, const char* table, const char* place) {
  return {db, table, {"search_id", place}};
}
Table<TuneVariableRecord> variables_of(SQLite::Database& db) {
  return parts<TuneVariableRecord>(db, "tune_variable", "variable");
}
Table<tune::Evaluation> evaluations_of(SQLite::Database& db) {
  return {db, "tune_evaluation", {"search_id", "evaluation"}};
}

template <class R>
void replace(Table<R> table, std::int64_t id, const std::vector<R>& rows) {
  table.erase(id);
  for (std::size_t i = 0; i < rows.size(); ++i) table.insert(rows[i], id, i);
}

template <typename Work>
auto guarded(Writer& writer, const Work& work) {
  SQLite::Database& db = writer.database();
  try {
    return work(db);
  } catch (const SQLite::Exception& error) {
    throw explain(error, db.getFilename(), StoreError::Kind::kInterrupted);
  } catch (const std::invalid_argument& error) {
    throw unusable(db.getFilename(),
                   fmt::format("its search is damaged, or of another version of moma: {}", error.what()));
  }
}

template <typename Work>
void write(Writer& writer, const Work& work) {
  guarded(writer, [&](SQLite::Database& db) {
    writer.flush();  // the trials of a record are committed before it
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    work(db);
    transaction.commit();
  });
}

/// Changes the search's row.
template <typename Change>
void change(SQLite::Database& db, std::int64_t id, const Change& how) {
  Table<TuneSearchRecord> table = searches(db);
  TuneSearchRecord search = table.find(id).value();
  how(search);
  table.update(search, id);
}

}  // namespace

void add_result(TuneSearchRecord& search, const tune::SearchResult& result) {
  search.trials = result.trials;
  search.trials_saved = result.trials_saved;
  search.evaluations_cut = result.evaluations_cut;
  Json runs = Json::array();
  for (const tune::RunNote& run : result.runs)
    runs.push_back({{"algorithm", run.algorithm},
                    {"start", run.start},
                    {"trials", run.trials},
                    {"evaluations", run.evaluations},
                    {"end", run.end}});
  search.runs = runs.dump();
  search.notes = Json(result.notes).dump();
}

void add_result(std::vector<TuneVariableRecord>& variables, const tune::SearchResult& result) {
  for (std::size_t i = 0; i < result.found.size(); ++i) {
    variables.at(i).found = result.found[i];
    variables[i].importance = result.importance[i];
  }
}

std::vector<TuneSensitivityRecord> sensitivity_records(const tune::Sensitivity& sensitivity) {
  std::vector<TuneSensitivityRecord> steps;
  for (const tune::SensitivityStep& s : sensitivity.steps)
    steps.push_back({s.variable, {}, s.value, s.change, s.error, s.valid});
  for (const tune::SensitivityPair& s : sensitivity.pairs)
    steps.push_back({s.first, s.second, {}, s.interaction, s.error, true});
  return steps;
}

TuneRecords::TuneRecords(Writer& writer, TuneSearchRecord search, const std::vector<tune::Variable>& variables)
    : writer_(writer) {
  write(writer, [&](SQLite::Database& db) {
    search.hash = hash_text(search.identity);
    if (const auto id = row<std::int64_t>(db, "SELECT id FROM tune_search WHERE hash = ?", search.hash)) {
      id_ = *id;
      change(db, id_, [](TuneSearchRecord& s) { s.status = SearchStatus::kRunning, s.ended.reset(); });
    } else {
      search.started = utc_now();
      id_ = searches(db).insert(search);
      std::vector<TuneVariableRecord> records;
      for (const tune::Variable& variable : variables) records.push_back({variable, {}, {}});
      replace(variables_of(db), id_, records);
    }
    present_ = count(db, "SELECT count(*) FROM tune_evaluation WHERE search_id = ?", id_);
  });
}

std::optional<tune::Evaluation> TuneRecords::find(std::uint64_t evaluation) {
  if (evaluation >= present_) return std::nullopt;  // nothing beyond was stored before this run
  return guarded(writer_, [&](SQLite::Database& db) { return evaluations_of(db).find(id_, evaluation); });
}

void TuneRecords::append(const tune::Evaluation& evaluation) {
  write(writer_, [&](SQLite::Database& db) { evaluations_of(db).insert(evaluation, id_); });
}

void TuneRecords::stopped() {
  write(writer_, [&](SQLite::Database& db) {
    change(db, id_, [](TuneSearchRecord& s) { s.status = SearchStatus::kStopped, s.ended = utc_now(); });
  });
}

void TuneRecords::finish(const tune::SearchResult& result) {
  write(writer_, [&](SQLite::Database& db) {
    change(db, id_, [&](TuneSearchRecord& search) {
      search.ended = utc_now();
      add_result(search, result);
      search.status = SearchStatus::kFinished;
    });
    std::vector<TuneVariableRecord> variables = variables_of(db).all(id_);
    add_result(variables, result);
    replace(variables_of(db), id_, variables);
    replace(parts<tune::Finalist>(db, "tune_finalist", "place"), id_, result.finalists);
    replace(parts<TuneSensitivityRecord>(db, "tune_sensitivity", "entry"), id_,
            sensitivity_records(result.sensitivity));
  });
}

void TuneRecords::verdict(const std::string& held_out_suite, const std::string& held_out,
                          const std::vector<TuneComparisonRecord>& rows, tune::Verdict overall) {
  write(writer_, [&](SQLite::Database& db) {
    change(db, id_,
           [&](TuneSearchRecord& s) { s.held_out_suite = held_out_suite, s.held_out = held_out, s.verdict = overall; });
    replace(parts<TuneComparisonRecord>(db, "tune_comparison", "entry"), id_, rows);
  });
}

}  // namespace moma::store
