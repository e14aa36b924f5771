#include "reports/render/report.h"

#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <fstream>
#include <string>

#include "reports/render/html.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

std::string message(const std::filesystem::path& db, const std::filesystem::path& html) {
  try {
    write_report({db}, html);
  } catch (const ReportError& error) {
    return error.what();
  }
  return "";
}

void expect_refused(const std::filesystem::path& db, const std::filesystem::path& html, const std::string& part) {
  const std::string text = message(db, html);
  EXPECT_NE(text.find(part), std::string::npos) << "message: " << text;
}

TEST(Report, OneFileThatReachesNothing) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 10);
  write_report({folder / "a.db"}, folder / "deep" / "a.html");
  const std::string page = read_file(folder / "deep" / "a.html");
  EXPECT_EQ(page.rfind("<!doctype html>", 0), 0u);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(count(page, "</script"), 2);  // the data block and the script, whatever they hold
  for (const auto& entry : std::filesystem::directory_iterator(folder / "deep"))
    EXPECT_EQ(entry.path().filename(), "a.html");
}

TEST(Report, HostileNamesAreText) {
  const Folder folder;
  make_store(folder / "a.db", "hostile", 12);
  write_report({folder / "a.db"}, folder / "a.html");
  const std::string page = read_file(folder / "a.html");
  EXPECT_EQ(count(page, "</script"), 2);
  EXPECT_EQ(page.find("<script>document.title"), std::string::npos);
  EXPECT_EQ(page.find("<b>bold"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/script&gt;"), std::string::npos);
  const nlohmann::json data = data_of(page);
  EXPECT_EQ(data.at("points").at(0).at("suite"), "</script><script>document.title=\"taken\"</script>");
  EXPECT_EQ(data.at("points").at(1).at("controller"), "quo\"te's & <b>bold</b>");
  EXPECT_EQ(data.at("points").at(0).at("robot"),
            "na\xc3\xafve \xe2\x80\x93 \xe6\x9c\xba\xe5\x99\xa8\xe4\xba\xba \xf0\x9f\xa4\x96");
}

TEST(Report, EscapesAnyBytes) {
  EXPECT_EQ(escape("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(escape("\xff"), "\xef\xbf\xbd");
  EXPECT_EQ(script_json({{"k", "<!--\xfe"}}), "{\"k\":\"\\u003c!--\xef\xbf\xbd\"}");
}

TEST(Report, EmptyStoreGivesAPage) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  const nlohmann::json data = page_of({folder / "a.db"});
  EXPECT_EQ(data.at("trials").at("n"), 0);
  EXPECT_TRUE(data.at("summary").empty());
}

TEST(Report, RunningStoreIsReadAsItWasAtOneMoment) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 10);
  SQLite::Database writer((folder / "a.db").string(), SQLite::OPEN_READWRITE);
  SQLite::Transaction pending(writer);
  writer.exec("DELETE FROM samples");
  writer.exec("UPDATE trial SET outcome = 'error'");
  const nlohmann::json data = page_of({folder / "a.db"});
  EXPECT_EQ(data.at("trials").at("n"), 20);
  EXPECT_GT(data.at("samples_stored"), 0);
  EXPECT_GT(data.at("overall").at(0).at("success_rate"), 0.0);
}

TEST(Report, TheSameStoreGivesTheSameBytes) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 10);
  write_report({folder / "a.db"}, folder / "a.html");
  write_report({folder / "a.db"}, folder / "b.html");
  EXPECT_EQ(read_file(folder / "a.html"), read_file(folder / "b.html"));
}

TEST(Report, RefusesWhatIsNoStore) {
  const Folder folder;
  expect_refused(folder / "none.db", folder / "a.html", "there is no such file");
  expect_refused(folder.path(), folder / "a.html", "this is a folder");
  std::ofstream(folder / "text.db") << std::string(4096, 'x');
  expect_refused(folder / "text.db", folder / "a.html", "not an SQLite file");
  std::ofstream(folder / "nothing.db").flush();
  expect_refused(folder / "nothing.db", folder / "a.html", "belongs to another program");
  SQLite::Database((folder / "other.db").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE t (a)");
  expect_refused(folder / "other.db", folder / "a.html", "belongs to another program");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
}

TEST(Report, RefusesOtherSchemas) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  const auto set_version = [&](const std::string& version) {
    change(folder / "a.db", "PRAGMA user_version = " + version);
  };
  set_version("99");
  expect_refused(folder / "a.db", folder / "a.html", "a newer moma wrote this store (schema 99");
  set_version("0");
  expect_refused(folder / "a.db", folder / "a.html", "an older moma wrote this store (schema 0");
}

TEST(Report, DamagedSamplesNameTheTrial) {
  const Folder folder;
  make_store(folder / "a.db", "one", 1);
  change(folder / "a.db", "UPDATE samples SET data = x'0102'");
  expect_refused(folder / "a.db", folder / "a.html", "samples");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
}

TEST(Report, NoPlaceForThePage) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  std::ofstream(folder / "file") << "x";
  expect_refused(folder / "a.db", folder / "file" / "a.html", "cannot be written");
  std::filesystem::create_directory(folder / "b.html");
  expect_refused(folder / "a.db", folder / "b.html", "is a folder");
}

TEST(Report, AFailedReportLeavesTheOldPage) {
  const Folder folder;
  std::ofstream(folder / "a.html") << "the old page";
  EXPECT_NE(message(folder / "none.db", folder / "a.html"), "");
  EXPECT_EQ(read_file(folder / "a.html"), "the old page");
}

}  // namespace
}  // namespace moma::reports
