// Proves: a file that is written takes its place whole or not at all, whatever stands there (a link, a device, another
// mode, a name as long as names get), files that belong together change together whatever happens between them, and
// what a dead process left is put in order by whoever comes next. Failures of the system's own calls, one by one, are
// tests/reliability/faults' affair.
#include "burin/base/files/write_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

mode_t mode_of(const fs::path& file) {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 ? found.st_mode & 07777 : 0;
}

TEST(WriteFile, LinksStayAndAreFollowedAndModesStay) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "elsewhere");
  folder.write("elsewhere/real.csv", "old");
  fs::permissions(folder / "elsewhere/real.csv", fs::perms(0600));
  fs::create_symlink("elsewhere/real.csv", folder / "one.csv");
  fs::create_symlink("one.csv", folder / "two.csv");
  write_text("new", folder / "two.csv");
  EXPECT_TRUE(fs::is_symlink(folder / "two.csv") && fs::is_symlink(folder / "one.csv"));
  EXPECT_EQ(file_text(folder / "elsewhere/real.csv"), "new");
  EXPECT_EQ(mode_of(folder / "elsewhere/real.csv"), 0600U);
  // A link to what is not there yet: it will be.
  fs::create_symlink("elsewhere/later.csv", folder / "later.csv");
  write_text("first", folder / "later.csv");
  EXPECT_EQ(file_text(folder / "elsewhere/later.csv"), "first");
  fs::create_symlink("round", folder / "round");
  EXPECT_THAT([&] { write_text("x", folder / "round"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("symbolic links"), HasSubstr("circle"))));
  EXPECT_THAT(names_in(folder / "elsewhere"), ElementsAre("later.csv", "real.csv"));
}

// A stranger's project: names that Burin makes within it stay within it.
TEST(NamedPaths, NoLinkLeadsOutOfAFolderThatWasNamed) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "p/round");
  folder.write("home/rc", "mine");
  fs::create_symlink("../home/rc", folder / "p/report.html");
  fs::create_symlink("../home/new", folder / "p/bench.json");
  fs::create_symlink("report.html", folder / "p/chain.html");
  fs::create_symlink("round/page.html", folder / "p/page.html");
  fs::create_directory_symlink("../home", folder / "p/previews");
  const auto refused = [&](const auto& work, const std::string& link, const std::string& target) {
    EXPECT_THAT(work, ThrowsMessage<Error>(AllOf(HasSubstr("the symbolic link " + (folder / link).string()),
                                                 HasSubstr((folder / target).string()), HasSubstr("; remove that"))));
  };
  {
    const NamedPaths named({"report", (folder / "p").string() + "/", "--threads=2", "-", "--"});
    refused([&] { write_text("x", folder / "p/report.html"); }, "p/report.html", "home/rc");
    refused([&] { write_text("x", folder / "p/bench.json"); }, "p/bench.json", "home/new");
    refused([&] { write_text("x", folder / "p/round/../chain.html"); }, "p/chain.html", "home/rc");
    refused([&] { write_text("x", folder / "p/previews/a.png"); }, "p/previews", "home/a.png");
    refused([&] { remove_file(folder / "p/previews/rc"); }, "p/previews", "home/rc");
    refused([&] { make_output_folder(folder / "p/previews/more"); }, "p/previews", "home/more");
    {
      FilesTogether all;
      write_text("x", folder / "p/new.html");
      refused([&] { write_text("x", folder / "p/report.html"); }, "p/report.html", "home/rc");
    }
    EXPECT_FALSE(fs::exists(folder / "p/new.html"));
    write_text("within", folder / "p/page.html");
  }
  EXPECT_EQ(file_text(folder / "p/round/page.html"), "within");
  EXPECT_TRUE(fs::is_symlink(folder / "p/page.html"));
  EXPECT_EQ(file_text(folder / "home/rc"), "mine");
  EXPECT_THAT(names_in(folder / "home"), ElementsAre("rc"));
  {  // a file by its own path, a folder that is a link itself, and what lies on the way to either
    const NamedPaths named(
        {"x", "--out=" + (folder / "p/report.html").string(), (folder / "p/previews/deep/a").string()});
    write_text("asked for", folder / "p/report.html");
    make_output_folder(folder / "p/previews/deep");
    write_text("beside it", folder / "p/previews/deep/b");
  }
  EXPECT_EQ(file_text(folder / "home/rc"), "asked for");
  EXPECT_EQ(file_text(folder / "home/deep/b"), "beside it");
  write_text("by another program", folder / "p/bench.json");
  EXPECT_EQ(file_text(folder / "home/new"), "by another program");
}

// `--out thesis.txt`, said by mistake.
TEST(NamedPaths, AFileOfAnotherKindIsNotReplaced) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const std::string page = "<!doctype html>\n<meta name=\"generator\" content=\"burin 1\">new";
  const std::string map = R"({"format": "burin/heights"})";
  const auto write = [&](const std::string& there, const std::string& now) {
    folder.write("out", there);
    const NamedPaths named({"x", "--out", out.string()});
    write_text(now, out);
    write_text("again, by the same command", out);
  };
  for (const std::string there :
       {"my thesis", "<html>of mine</html>", "\x89PNG\r\n\x1a\n", R"({"format": "burin/board"})", "[1, 2]", "PK\3\4"})
    for (const std::string& now : {page, map}) {
      EXPECT_THAT([&] { write(there, now); }, ThrowsMessage<Error>(HasSubstr("would replace it"))) << there;
      EXPECT_EQ(file_text(out), there);
    }
  EXPECT_EQ(folder.file_count(), 1u);
  write("<!DOCTYPE HTML>\n<title>Burin</title>", page);
  write(R"({"version": 1, "format":"burin/heights"})", map);
  write("", page);
  EXPECT_EQ(file_text(out), "again, by the same command");
  folder.write("out", "text");
  write_text(page, out);  // by another program
  EXPECT_EQ(file_text(out), page);
}

TEST(WriteFile, WhatIsNoFileIsRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo.json").c_str(), 0600), 0);
  EXPECT_THAT([&] { write_text("x", folder / "fifo.json"); }, ThrowsMessage<Error>(HasSubstr("a FIFO")));
  EXPECT_TRUE(fs::is_fifo(folder / "fifo.json"));
  EXPECT_THAT([] { write_text("x", "/dev/null"); }, ThrowsMessage<Error>(HasSubstr("a device")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT([&] { write_text("x", folder.path()); }, ThrowsMessage<Error>(HasSubstr("is a folder")));
  folder.write("file", "x");
  EXPECT_THAT([&] { write_text("x", folder / "file/a.json"); }, ThrowsMessage<Error>(HasSubstr("; ")));
  EXPECT_THAT([&] { write_text("x", folder / std::string("cut\0off.json", 12)); },
              ThrowsMessage<Error>(HasSubstr("zero byte")));
  EXPECT_FALSE(fs::exists(folder / "cut"));
}

TEST(WriteFile, NamesAsLongAsNamesGet) {
  const TemporaryFolder folder;
  const std::string ending = ".gcode";
  for (const std::size_t length : {200U, 240U, 255U}) {
    const fs::path file = folder / (std::string(length - ending.size(), 'a') + ending);
    write_text("G1", file);
    EXPECT_EQ(file_text(file), "G1") << length;
  }
  EXPECT_THAT([&] { write_text("G1", folder / std::string(256, 'a')); },
              ThrowsMessage<Error>(HasSubstr("shorter names")));
  EXPECT_EQ(names_in(folder.path()).size(), 3U);
}

TEST(WriteFile, ARefusedFileLeavesTheOldOne) {
  const TemporaryFolder folder;
  folder.write("a.json", "old");
  const auto refuse = [](const fs::path& part) {
    EXPECT_EQ(file_text(part), "new");
    EXPECT_EQ(part.extension(), ".json");
    throw Error("not good");
  };
  EXPECT_THAT([&] { write_file("new", folder / "a.json", Durability::on_disk, refuse); },
              ThrowsMessage<Error>("not good"));
  EXPECT_EQ(file_text(folder / "a.json"), "old");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a.json"));
}

TEST(WriteFile, SamePixelsGiveTheSameBytesOfEachKind) {
  const TemporaryFolder folder;
  Image image(7, 5, 3, 0.25F);
  image.at(2, 3, 1) = 0.75F;
  for (const char* kind : {".png", ".jpg", ".tif", ".exr"}) {
    write_picture(image, folder / (std::string("a") + kind));
    write_picture(image, folder / (std::string("b") + kind));
    const std::string bytes = file_text(folder / (std::string("a") + kind));
    EXPECT_EQ(bytes, file_text(folder / (std::string("b") + kind))) << kind;
    EXPECT_THAT(bytes, Not(HasSubstr("20" + std::string(__DATE__).substr(9, 2) + ":"))) << kind << " holds a date";
    const Image back = read_picture(folder / (std::string("a") + kind));
    EXPECT_NEAR(back.at(6, 0, 1), 0.25F, 0.05F) << kind;  // far from the dot, which JPEG smears
  }
}

TEST(WriteFile, ACopyIsWholeAndAsPrivateAsItsOriginal) {
  const TemporaryFolder folder;
  folder.write("photo.jpg", std::string(3'000'000, 'x'));
  fs::permissions(folder / "photo.jpg", fs::perms(0400));
  copy_whole(folder / "photo.jpg", folder / "copy.jpg");
  EXPECT_EQ(file_text(folder / "copy.jpg"), std::string(3'000'000, 'x'));
  EXPECT_EQ(mode_of(folder / "copy.jpg"), 0600U);
  EXPECT_THAT([&] { copy_whole(folder / "none", folder / "copy.jpg"); }, ThrowsMessage<Error>(HasSubstr("none")));
  EXPECT_THAT([&] { copy_whole(folder.path(), folder / "copy.jpg"); },
              ThrowsMessage<Error>(HasSubstr("no plain file")));
  EXPECT_EQ(fs::file_size(folder / "copy.jpg"), 3'000'000U);
}

TEST(FilesTogether, NothingChangesBeforeAllIsWritten) {
  const TemporaryFolder folder;
  folder.write("a.json", "old a");
  folder.write("gone.json", "old");
  {
    FilesTogether all;
    write_text("new a", folder / "a.json");
    write_text("new b", folder / "b.json");
    remove_file(folder / "gone.json");
    EXPECT_EQ(file_text(folder / "a.json"), "old a");
    EXPECT_EQ(file_text(as_written(folder / "a.json")), "new a");
  }  // an exception on the way
  EXPECT_EQ(file_text(folder / "a.json"), "old a");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a.json", "gone.json"));

  FilesTogether all;
  write_text("first a", folder / "a.json");
  write_text("new a", folder / "a.json");  // the last one counts
  write_text("new b", folder / "b.json");
  remove_file(folder / "gone.json");
  all.put();
  EXPECT_EQ(file_text(folder / "a.json"), "new a");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a.json", "b.json"));
  write_text("later", folder / "c.json");  // is none of the change
  EXPECT_EQ(file_text(folder / "c.json"), "later");
}

TEST(FilesTogether, AMoveThatFailsIsTakenBackWithAllBeforeIt) {
  const TemporaryFolder folder;
  folder.write("a.json", "old a");
  FilesTogether all;
  write_text("new a", folder / "a.json");
  write_text("new b", folder / "b.json");
  write_text("new c", folder / "c.json");
  fs::create_directories(folder / "c.json");  // someone made a folder of that name meanwhile
  folder.write("c.json/full", "x");
  EXPECT_THAT([&] { all.put(); }, ThrowsMessage<Error>(AllOf(HasSubstr("c.json"), HasSubstr("as before"))));
  EXPECT_EQ(file_text(folder / "a.json"), "old a");
  EXPECT_FALSE(fs::exists(folder / "b.json"));
}

ino_t inode_of(const fs::path& file) {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 ? found.st_ino : 0;
}

// A journal with these fields, as a change of several files lays it down.
void lay_journal(const fs::path& file, const std::vector<std::string>& fields) {
  std::string text("burin/change 2");
  text += '\0';
  for (const std::string& field : fields) (text += field) += '\0';
  std::ofstream(file, std::ios::binary) << text + "end";
}

// The process dies at its n-th rename, by a file system's mishap that only a debugger could time: its journal and part
// files are laid down as they are then.
void die_between(const fs::path& folder, const char* journal, int moved) {
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string mark = ".part-" + std::to_string(::getpid()) + "-";
    const auto lay = [&](const std::string& name, const std::string& text) {
      std::ofstream(folder / name, std::ios::binary) << text;
    };
    std::vector<std::string> fields;
    for (const std::string name : {"a", "b"}) {
      const std::string part = "." + name + mark + "0.json", former = "." + name + mark + "1.json";
      lay(part, "new " + name);
      for (const std::string& field :
           {name + ".json", part, former, std::to_string(inode_of(folder / (name + ".json"))),
            std::to_string(inode_of(folder / part))})
        fields.push_back(field);
    }
    lay_journal(folder / journal, fields);
    int left = moved;
    for (const std::string name : {"a", "b"}) {
      if (left-- <= 0) break;
      if (fs::exists(folder / (name + ".json")))
        fs::create_hard_link(folder / (name + ".json"), folder / ("." + name + mark + "1.json"));
      fs::rename(folder / ("." + name + mark + "0.json"), folder / (name + ".json"));
    }
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
}

TEST(FilesTogether, WhoComesNextCompletesWhatADeadProcessBegan) {
  for (const int moved : {0, 1, 2}) {
    const TemporaryFolder folder;
    folder.write("a.json", "old a");
    die_between(folder.path(), ".burin-change", moved);
    std::string said;
    report_settled_changes([&](const std::string& sentence) { said += sentence; });
    EXPECT_EQ(read_text(folder / "a.json"), "new a") << moved;  // read_text puts it in order
    report_settled_changes({});
    EXPECT_EQ(file_text(folder / "b.json"), "new b") << moved;
    EXPECT_THAT(names_in(folder.path()), ElementsAre("a.json", "b.json")) << moved;
    EXPECT_THAT(said, HasSubstr("a change of 2 files had been cut off here, and is now completed"));
  }
}

// A person unpacks a stranger's archive: a journal in it acts only where something was named, or in its project.
TEST(FilesTogether, AJournalActsWithinWhatWasNamedOnly) {
  for (const bool is_project : {false, true}) {
    const TemporaryFolder folder;
    folder.write("up/a.json", "old a");
    folder.write("up/sub/board.csv", "x");
    if (is_project) {
      folder.write("up/design.json", "{}");
      folder.write("up/board.json", "{}");
    }
    die_between(folder / "up", ".burin-change", 0);
    {
      const NamedPaths named({"view", (folder / "up/sub/board.csv").string()});
      read_text(folder / "up/sub/board.csv");
      EXPECT_EQ(file_text(folder / "up/a.json"), is_project ? "new a" : "old a");
      if (!is_project) {
        EXPECT_THAT([&] { read_text(folder / "up/a.json"); },
                    ThrowsMessage<Error>(AllOf(HasSubstr("was cut off in"), HasSubstr("name that folder"))));
      }
    }
    const NamedPaths named({"view", (folder / "up").string()});
    EXPECT_EQ(read_text(folder / "up/a.json"), "new a");
  }
}

// Nor on other files than those that were written for it: an archive cannot know their numbers.
TEST(FilesTogether, AJournalOfAnotherDiskChangesNothing) {
  const TemporaryFolder folder;
  folder.write("thesis.txt", "mine");
  folder.write("b.json", "mine too");
  folder.write(".b.part-1-0.json", "theirs");
  lay_journal(folder / ".burin-change", {"b.json", ".b.part-1-0.json", ".b.part-1-1.json", "0", "1"});
  EXPECT_THAT([&] { read_text(folder / "b.json"); }, ThrowsMessage<Error>(HasSubstr(".burin-change to take what is")));
  fs::remove(folder / ".b.part-1-0.json");
  lay_journal(folder / ".burin-change", {"thesis.txt", "", ".thesis.part-1-1.txt", "1", "0"});  // a removal
  EXPECT_EQ(read_text(folder / "b.json"), "mine too");
  lay_journal(folder / ".burin-change-back", {"thesis.txt", ".thesis.part-1-0.txt", ".thesis.part-1-1.txt", "0", "1"});
  EXPECT_EQ(read_text(folder / "b.json"), "mine too");
  EXPECT_EQ(file_text(folder / "thesis.txt"), "mine");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("b.json", "thesis.txt"));
}

TEST(FilesTogether, OrTakesBackWhatItWasTakingBack) {
  for (const int moved : {0, 1, 2}) {
    const TemporaryFolder folder;
    folder.write("a.json", "old a");
    die_between(folder.path(), ".burin-change-back", moved);
    EXPECT_EQ(read_text(folder / "a.json"), "old a") << moved;
    EXPECT_THAT(names_in(folder.path()), ElementsAre("a.json")) << moved;
  }
}

TEST(FilesTogether, AStrangersJournalRenamesNothingElse) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "project");
  folder.write("secret.txt", "mine");
  folder.write("project/plain.txt", "a");
  const auto journal = [&](std::vector<std::string> fields) {
    fields.insert(fields.end(),
                  {std::to_string(inode_of(folder / "project" / fields[0])), fields[1].empty() ? "0" : "1"});
    lay_journal(folder / "project/.burin-change", fields);
    settle_changes(folder / "project/any.json");
    EXPECT_FALSE(fs::exists(folder / "project/.burin-change"));
  };
  journal({"../secret.txt", "../.secret.part-1-0.txt", "../.secret.part-1-1.txt"});
  journal({(folder / "secret.txt").string(), ".secret.part-1-0.txt", ".secret.part-1-1.txt"});
  journal({"taken.txt", "plain.txt", ".taken.part-1-0.txt"});                              // no part file
  journal({"plain.txt", ".other.part-1-0.txt", ".plain.part-1-1.txt"});                    // another file's
  journal({"plain.txt", "", "../stolen"});                                                 // moved out
  journal({".a.part-1-0.txt", "..a.part-1-0.part-1-0.txt", "..a.part-1-0.part-1-1.txt"});  // hidden
  fs::create_directory_symlink(folder.path(), folder / "project/out");
  journal({"out/secret.txt", "", "out/.secret.part-1-0.txt"});
  EXPECT_EQ(file_text(folder / "secret.txt"), "mine");
  EXPECT_EQ(file_text(folder / "project/plain.txt"), "a");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("project", "secret.txt"));
}

TEST(WriteFile, PartFilesOfDeadProcessesAreCleared) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  const std::string dead = std::to_string(child), alive = std::to_string(::getppid()), own = std::to_string(::getpid());
  folder.write(".a.part-" + dead + "-0.json", "half");
  folder.write(".a.part-" + alive + "-0.json", "at work");
  folder.write(".a.part-" + own + "-99999.json", "of an earlier process of this number");
  folder.write(".a.part-time", "a person's");
  write_text("x", folder / "b.json");
  EXPECT_THAT(names_in(folder.path()),
              ::testing::UnorderedElementsAre(".a.part-" + alive + "-0.json", ".a.part-time", "b.json"));
}

TEST(FileNames, DistinctInAnyScript) {
  EXPECT_THAT(distinct_file_names({"左", "右", "v00", "a b", "a/b", "A_B"}),
              ElementsAre("左", "右", "v00", "a_b", "a_b-2", "A_B-3"));
  // A view's second file is not another view's first.
  EXPECT_THAT(distinct_file_names({"left", "left-start"}, {"-start"}), ElementsAre("left", "left-start-2"));
  // The same letters with marks in one or apart are one name on some systems; letters that differ are not.
  EXPECT_THAT(distinct_file_names({"caf\u00e9", "cafe\u0301", "\u00e4", "\u00f6", "\u304c", "\u304b\u3099"}),
              ElementsAre("caf\u00e9", "cafe\u0301-2", "\u00e4", "\u00f6", "\u304c", "\u304b\u3099-2"));
  EXPECT_THAT(distinct_file_names({"\ud55c", "\u1112\u1161\u11ab"}), ElementsAre("\ud55c", "\u1112\u1161\u11ab-2"));
  EXPECT_THAT(distinct_file_names({"cafe\u0301", "caf\u00e9", "cafe"}),
              ElementsAre("cafe\u0301", "caf\u00e9-2", "cafe"));
  EXPECT_EQ(file_name_of("..") + file_name_of("") + file_name_of(".hidden"), "_.__hidden");
  EXPECT_EQ(file_name_of("../../etc/passwd"), "_._.._etc_passwd");
  EXPECT_EQ(file_name_of("-rf"), "_rf");
  EXPECT_EQ(file_name_of("a\xFF\xC0\xAF"), "a___");  // no UTF-8
  EXPECT_EQ(file_name_of("a\xE2\x80\xAE"
                         "gpj.exe"),
            "a_gpj.exe");  // right to left
  EXPECT_EQ(file_name_of(std::string(3, '\0')), "___");
  std::string many;
  for (int i = 0; i < 100; ++i) many += "ب";
  EXPECT_EQ(file_name_of(many).size(), 100U);
  EXPECT_EQ(distinct_file_names({many, many + "x"}).back(), file_name_of(many) + "-2");
}

}  // namespace
}  // namespace burin
