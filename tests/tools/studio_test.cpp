// Proves, of `burin studio`: nobody but the person at this machine gets in (host, origin, token, cookie); no request
// leads out of the folder or makes it end; its work is the commands' work, with the same bits; work outlives the
// server; it ends at once, and takes no processor time while nothing happens.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "tests/places.h"
#include "tests/temporary_folder.h"
#include "tests/tools/chromium.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"
#include "tests/tools/studio_under_test.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

std::string sample_picture(const std::string& name) {
  return file_text(places::source() + "/samples/small-bench/targets/" + name);
}

// A project as `burin new` makes it, without its design of seven seconds.
void copy_sample_project(const fs::path& to) {
  fs::copy(fs::path(places::source()) / "samples/small-bench", to, fs::copy_options::recursive);
  fs::remove(to / "truth.json");
}

const char* const kSmallLoop =
    R"({"action": "loop", "count": "150", "pixels": "32", "iterations": "5", "travel": "unknown"})";

TEST(Studio, OnlyTheBrowserWithTheTokenGetsIn) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  StudioUnderTest studio(folder / "hum");
  EXPECT_EQ(studio.get("/").status, 403) << "without a cookie";
  EXPECT_EQ(studio.get("/?token=" + std::string(48, '0')).status, 403) << "with a guessed token";
  const std::string first = studio.address;
  studio.enter();
  EXPECT_EQ(studio.get("/").status, 200);
  EXPECT_EQ(
      studio.raw("GET " + first.substr(first.find("/?")) + " HTTP/1.1\r\nHost: " + studio.host + "\r\n\r\n").status,
      403)
      << "a token serves once";
  EXPECT_NE(studio.next_address(), first) << "for another browser";

  const auto with = [&](const std::string& head) {
    return studio.raw(head + "Cookie: " + studio.cookie + "\r\n\r\n").status;
  };
  const std::string port = std::to_string(studio.port);
  EXPECT_EQ(with("GET / HTTP/1.1\r\nHost: localhost:" + port + "\r\n"), 200);
  EXPECT_EQ(with("GET / HTTP/1.1\r\nHost: evil.example:" + port + "\r\n"), 421) << "a name that was made to lead here";
  EXPECT_EQ(with("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"), 421);
  EXPECT_EQ(with("GET / HTTP/1.1\r\n"), 421);
  EXPECT_EQ(with("GET / HTTP/1.1\r\nHost: " + studio.host + "\r\nHost: evil.example\r\n"), 421);
  EXPECT_EQ(with("GET /api/state HTTP/1.1\r\nHost: " + studio.host + "\r\nSec-Fetch-Site: cross-site\r\n"), 403);
  const std::string stop = "POST /api/stop HTTP/1.1\r\nContent-Length: 2\r\nHost: " + studio.host + "\r\n";
  EXPECT_EQ(with(stop), 403) << "without an origin";
  EXPECT_EQ(with(stop + "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(with(stop + "Origin: null\r\n"), 403) << "a sandboxed page, or a file";
  EXPECT_EQ(with(stop + "Origin: https://" + studio.host + "\r\n"), 403);
  EXPECT_EQ(studio.post("/api/stop", "{}").status, 200);
  EXPECT_EQ(with("DELETE / HTTP/1.1\r\nHost: " + studio.host + "\r\n"), 405);
  EXPECT_EQ(with("OPTIONS / HTTP/1.1\r\nHost: " + studio.host + "\r\n"), 405);

  const StudioReply page = studio.get("/");
  EXPECT_THAT(page.head, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(page.head, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(page.head, HasSubstr("Cache-Control: no-store"));
  EXPECT_THAT(page.body, Not(HasSubstr("http://"))) << "no external request";
}

TEST(Studio, NoPathLeadsOut) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  folder.write("secret.json", "{}");
  folder.write("hum/.hidden.json", "{}");
  folder.write("hum/notes.txt", "mine");
  folder.write("hum/evil.html", "<script>fetch('/api/state')</script>");
  fs::create_symlink(folder / "secret.json", folder / "hum/link.json");
  fs::create_directory_symlink(folder.path(), folder / "hum/round-07");
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  EXPECT_EQ(studio.get("/file/design.json").status, 200);
  EXPECT_EQ(studio.get("/file/targets/moon.png").status, 200);
  for (const char* path :
       {"/file/../secret.json", "/file/%2e%2e/secret.json", "/file/..%2fsecret.json", "/file/targets/../../secret.json",
        "/file/%2e%2e%2fsecret.json", "/file//etc/passwd", "/file/%2fetc%2fpasswd", "/file/link.json",
        "/file/round-07/secret.json", "/file/.hidden.json", "/file/.burin-lock", "/file/notes.txt", "/file/",
        "/file/targets", "/file/design.json%00.png", "/file/./design.json", "/thumb?file=../secret.json",
        "/thumb?file=/etc/passwd", "/target?view=../../x"}) {
    const StudioReply reply = studio.get(path);
    EXPECT_EQ(reply.status, 400) << path;
    EXPECT_THAT(reply.body, Not(HasSubstr("root:"))) << path;
  }
  EXPECT_EQ(studio.get("/" + std::string(3000, 'a')).status, 414);
  // A stranger's page gets no origin, so neither the cookie nor an answer is its.
  EXPECT_THAT(studio.get("/file/evil.html").head,
              HasSubstr("Content-Security-Policy: sandbox allow-scripts; default-src 'none'"));
}

TEST(Studio, UploadsAndWishesAreJudged) {
  const TemporaryFolder folder;
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  const std::string moon = sample_picture("moon.png");
  EXPECT_EQ(studio.post("/api/picture?name=moon.png", moon).status, 200);
  const StudioReply again = studio.post("/api/picture?name=..%2F..%2Fmoon.png", moon);
  EXPECT_EQ(again.json()["file"], "moon-2.png") << "a name loses its folders, and nothing is overwritten";
  const StudioReply odd = studio.post("/api/picture?name=%3Cimg%20src%3Dx%3E%22'.png", moon);
  EXPECT_THAT(odd.json()["file"].get<std::string>(), Not(HasSubstr("<")));
  EXPECT_EQ(studio.post("/api/picture?name=run.sh", moon).status, 400);
  EXPECT_EQ(studio.post("/api/picture?name=empty.png", "").status, 400);
  EXPECT_EQ(studio.post("/api/picture?name=text.png", "root:x:0:0").status, 400);
  EXPECT_EQ(studio.post("/api/picture?name=cut.png", moon.substr(0, moon.size() / 2)).status, 400);
  EXPECT_EQ(studio.post("/api/picture?name=packed.png", moon, "Content-Encoding: gzip\r\n").status, 415);
  const auto pictures = studio.get("/api/state?seen=0").json()["project"]["pictures"];
  EXPECT_EQ(pictures.size(), 3U) << pictures;
  EXPECT_EQ(studio.get("/thumb?file=moon.png").head.find("HTTP/1.1 200"), 0U);

  EXPECT_EQ(studio.post("/api/do", R"({"action": "rm -rf"})").status, 400);
  EXPECT_EQ(studio.post("/api/do", R"({"action": "simulate"})").status, 400);
  EXPECT_EQ(studio.post("/api/do", kSmallLoop).status, 400) << "there is no board yet";
  EXPECT_EQ(studio.post("/api/do", R"({"action": "new", "pictures": ["../../etc/passwd"]})").status, 400);
  EXPECT_EQ(studio.post("/api/do", R"({"action": "new", "pictures": ["moon.png"], "board": "1x1; touch x"})").status,
            400);
  EXPECT_EQ(studio.post("/api/do", "[1, 2").status, 400);
  EXPECT_EQ(studio.post("/api/do", std::string(200, '[')).status, 400);
  EXPECT_EQ(studio.post("/api/do", "{\"action\": \"" + std::string(200'000, 'a') + "\"}").status, 400);
  EXPECT_EQ(studio.post("/api/shutdown", "{}").status, 404);
  EXPECT_FALSE(fs::exists(folder / "hum")) << "nothing is made by what is refused";
}

TEST(Studio, EditsArePutIntoTheProjectAndTakenBack) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  const std::string design = file_text(folder / "hum/design.json"), bench = file_text(folder / "hum/bench.json");
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  EXPECT_EQ(
      studio.post("/api/edit", R"({"what": "view", "view": "d0", "fit": "cover", "keep": "top", "levels": [0.1, 0.9]})")
          .status,
      200);
  const auto written = nlohmann::json::parse(file_text(folder / "hum/design.json"));
  EXPECT_EQ(written["views"][0]["keep"], "top");
  EXPECT_EQ(written["views"][0]["levels"][1], 0.9);
  const std::string edited = file_text(folder / "hum/design.json");
  for (const char* wrong :
       {R"({"what": "view", "view": "d0", "keep": "sideways"})",
        R"({"what": "view", "view": "d0", "levels": [0.9, 0.1]})", R"({"what": "view", "view": "none", "keep": "top"})",
        R"({"what": "view", "view": "d0", "weight": -1})", R"({"what": "place", "lamps": {"lamp": [0, 0, -50]}})",
        R"({"what": "place", "lamps": {"lamp": [0, 0]}})"})
    EXPECT_EQ(studio.post("/api/edit", wrong).status, 400) << wrong;
  EXPECT_EQ(file_text(folder / "hum/design.json"), edited) << "what the program's readers refuse is not written";
  EXPECT_EQ(file_text(folder / "hum/bench.json"), bench);
  EXPECT_EQ(studio.post("/api/mask?view=d0", sample_picture("moon.png")).status, 200);
  EXPECT_EQ(studio.get("/target?view=d0&mask=1").status, 200);
  EXPECT_EQ(studio.post("/api/edit", R"({"what": "undo"})").status, 200);
  EXPECT_EQ(studio.post("/api/edit", R"({"what": "undo"})").status, 200);
  EXPECT_EQ(file_text(folder / "hum/design.json"), design);
  EXPECT_EQ(studio.post("/api/edit", R"({"what": "undo"})").status, 400);
}

// The page's requests make what the commands make.
TEST(Studio, MakesTheSameBitsAsTheCommands) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "page");
  fs::create_directories(folder / "commands");
  {
    StudioUnderTest studio(folder / "page/hum");
    studio.enter();
    for (const char* name : {"moon.png", "boat.png"})
      ASSERT_EQ(studio.post(std::string("/api/picture?name=") + name, sample_picture(name)).status, 200);
    ASSERT_EQ(studio
                  .post("/api/do",
                        R"({"action": "new", "pictures": ["boat.png", "moon.png"], "board": "120x90", "count": "150"})")
                  .status,
              200);
    ASSERT_EQ(studio.wait_for_work(120)["work"]["result"]["exit_code"], 0);
    EXPECT_FALSE(fs::exists(folder / "page/.hum.studio")) << "nothing is left beside the project";
    ASSERT_EQ(studio.post("/api/edit", R"({"what": "place", "lamps": {"lamp": [60, 450, 470]}})").status, 200);
    ASSERT_EQ(studio.post("/api/do", kSmallLoop).status, 200);
    EXPECT_EQ(studio.post("/api/do", kSmallLoop).status, 400) << "one command at a time";
    const auto state = studio.wait_for_work(120);
    ASSERT_EQ(state["work"]["result"]["exit_code"], 0) << state["work"].dump();
  }
  const std::string sample = places::source() + "/samples/small-bench/targets/";
  const Outcome made = run_burin(folder, {"new", "commands/hum", "--pictures", sample + "boat.png", sample + "moon.png",
                                          "--board", "120x90", "--count", "150"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  auto bench = nlohmann::ordered_json::parse(file_text(folder / "commands/hum/bench.json"));
  bench["lights"][0]["position_mm"] = {60, 450, 470};
  folder.write("commands/hum/bench.json", bench.dump(2));
  const Outcome looped = run_burin(
      folder, {"loop", "commands/hum", "--count", "150", "--pixels", "32", "--iterations", "5", "--travel", "unknown"});
  ASSERT_EQ(looped.exit_code, 0) << looped.err;
  for (const char* file :
       {"design.json", "board.json", "loop.toml", "round-01/scratches.csv", "round-01/sent.csv", "round-01/board.gcode",
        "round-01/board-frame.gcode", "round-01/design.json", "round-01/board.json"}) {
    const std::string of_page = file_text(folder / "page/hum" / file);
    EXPECT_FALSE(of_page.empty()) << file;
    EXPECT_EQ(of_page, file_text(folder / "commands/hum" / file)) << file;
  }
  EXPECT_EQ(nlohmann::json::parse(file_text(folder / "page/hum/bench.json")),
            nlohmann::json::parse(file_text(folder / "commands/hum/bench.json")));
  EXPECT_FALSE(fs::exists(folder / "page/hum/round-01/design/live.png")) << "a frame is no result";
}

TEST(Studio, WorkOutlivesTheServer) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  {
    StudioUnderTest studio(folder / "hum");
    studio.enter();
    ASSERT_EQ(studio.post("/api/do", kSmallLoop).status, 200);
    studio.end(SIGKILL);
  }
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  EXPECT_EQ(studio.get("/api/state?seen=0").json()["work"]["action"], "loop") << "it is taken up";
  const auto state = studio.wait_for_work(120);
  EXPECT_EQ(state["work"]["result"]["exit_code"], 0) << state["work"].dump();
  EXPECT_TRUE(fs::exists(folder / "hum/round-01/board.gcode"));
}

TEST(Studio, EndsAtOnceAndIdlesWithoutWork) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  studio.get("/api/state?seen=0");
  std::this_thread::sleep_for(std::chrono::seconds(3));  // its first `burin status`
  const std::string wait = "GET /api/state?seen=" + studio.get("/api/state?seen=0").json()["revision"].dump() +
                           " HTTP/1.1\r\nHost: " + studio.host + "\r\nCookie: " + studio.cookie + "\r\n\r\n";
  // Clients that leave, and one that stays.
  const int threads = studio.threads();
  for (int i = 0; i < 60; ++i) {
    const int fd = studio.connect();
    ::send(fd, wait.data(), wait.size(), MSG_NOSIGNAL);
    ::close(fd);
  }
  const int stays = studio.connect();
  ::send(stays, wait.data(), wait.size(), MSG_NOSIGNAL);
  EXPECT_EQ(studio.get("/studio.css").status, 200) << "those who wait block nobody";
  const double before = studio.processor_s();
  constexpr int kIdle_s = 4;
  std::this_thread::sleep_for(std::chrono::seconds(kIdle_s));
  EXPECT_LT(studio.processor_s() - before, 0.02 * kIdle_s) << "2 % of a core is far above a few file stamps per second";
  EXPECT_LE(studio.threads(), threads);
  EXPECT_LT(studio.end(SIGINT), 2.0) << "with a client that waits";
  ::close(stays);
}

// A phone in the network sees the next shot, sends its photos, and hears what is wrong with them.
TEST(Studio, JudgesThePhotosOfAPhone) {
  const TemporaryFolder folder;
  make_tiny_project(folder, {"d0", "c1"}, 0.5);
  StudioUnderTest studio(folder / "project", {"--lan", "127.0.0.2"});
  StudioDoor phone(studio.next_address());
  EXPECT_EQ(phone.get("/api/shots").status, 403) << "without its token";
  studio.enter();
  phone.cookie = studio.cookie;
  EXPECT_EQ(phone.get("/api/shots").status, 403) << "the other address's cookie is not its";
  phone.enter();
  EXPECT_EQ(phone.get("/?token=" + phone.address.substr(phone.address.find('=') + 1)).status, 303)
      << "several phones may come";
  for (const char* path :
       {"/api/state?seen=0", "/file/design.json", "/studio.js", "/thumb?file=targets/moon.png", "/qr.svg"})
    EXPECT_EQ(phone.get(path).status, 404) << path;
  for (const char* path :
       {"/api/do", "/api/stop", "/api/edit", "/api/picture?name=a.png", "/api/mask?view=d0", "/api/remove?file=a.png"})
    EXPECT_EQ(phone.post(path, "{}").status, 404) << path;
  EXPECT_EQ(studio.get("/qr.svg").status, 200);
  EXPECT_EQ(phone.post("/api/photo?name=a.png", sample_picture("moon.png")).status, 400)
      << "there is no board to photograph";

  ASSERT_EQ(studio.post("/api/do", kSmallLoop).status, 200);
  ASSERT_EQ(studio.wait_for_work(120)["work"]["result"]["exit_code"], 0);
  const Outcome workshop =
      run_burin(folder, {"simulate", "truth.json", "--scratches", "project/round-01/sent.csv", "--out", "workshop"});
  ASSERT_EQ(workshop.exit_code, 0) << workshop.err;
  std::size_t sent = 0;
  for (const auto& photo : fs::directory_iterator(folder / "workshop/photos")) {
    const StudioReply reply =
        phone.post("/api/photo?name=../" + photo.path().filename().string(), file_text(photo.path()));
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_TRUE(fs::exists(folder / "project/round-01/photos" / photo.path().filename()));
    EXPECT_EQ(
        phone.post("/api/photo?name=" + photo.path().filename().string(), file_text(photo.path())).json()["known"],
        true)
        << "a dropped connection sends twice";
    ++sent;
  }
  EXPECT_EQ(phone.post("/api/photo?name=b.jpg", "no picture").status, 400);
  std::size_t judged = 0;
  nlohmann::json shots;
  for (int i = 0; i < 150 && judged < sent; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    shots = phone.get("/api/shots?seen=0").json();
    judged = 0;
    if (shots["judge"].is_object())
      for (const auto& event : shots["judge"]["events"])
        if (event["event"] == "photo") ++judged;
  }
  EXPECT_EQ(judged, sent) << shots.dump();
  const auto& last = shots["judge"]["events"].back();
  EXPECT_FALSE(last["now"].get<std::string>().empty()) << "what to take next";
  EXPECT_EQ(shots["photos"], sent);
}

TEST(Studio, NamesAPortThatIsTaken) {
  const TemporaryFolder folder;
  StudioUnderTest studio(folder / "hum");
  const Outcome second = run_burin(folder, {"studio", "other", "--no-browser", "--port", std::to_string(studio.port)});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err, HasSubstr("cannot be listened on"));
  folder.write("full/letter.txt", "mine");
  EXPECT_THAT(run_burin(folder, {"studio", "full", "--no-browser"}).err, HasSubstr("is neither a project nor empty"));
}

// Requests of random bytes, and right ones with random faults. More of them: BURIN_STUDIO_REQUESTS=100000.
TEST(Studio, OutlivesRandomRequests) {
  const TemporaryFolder folder;
  copy_sample_project(folder / "hum");
  StudioUnderTest studio(folder / "hum");
  studio.enter();
  const char* wanted = std::getenv("BURIN_STUDIO_REQUESTS");
  const int count = wanted != nullptr ? std::atoi(wanted) : 2000;
  std::mt19937 random(58);
  const auto any = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::vector<std::string> paths{
      "/",       "/file/",    "/file/design.json", "/api/state?seen=",        "/thumb?file=",      "/target?view=d0",
      "/api/do", "/api/edit", "/api/photo?name=",  "/api/picture?name=a.png", "/api/mask?view=d0", "/qr.svg",
      "/?token="};
  const std::vector<std::string> bodies{
      "", "{}", R"({"what": "view", "view": "d0", "levels": )", R"({"action": "loop", "time": )", "[[[[", "\xff\xfe"};
  const auto noise = [&](std::size_t most) {
    std::string text(any(most), '\0');
    for (char& c : text) c = static_cast<char>(any(256));
    return text;
  };
  const std::string design = file_text(folder / "hum/design.json");
  int answered = 0;
  constexpr int kPatience_ms = 25;  // half of them are never answered, because they never end
  for (int i = 0; i < count; ++i) {
    std::string request;
    if (any(4) == 0) {
      request = noise(600);
    } else {
      const bool post = any(2) == 0;
      const std::string body = bodies[any(bodies.size())] + (any(2) == 0 ? noise(80) : "");
      request = std::string(post ? "POST " : "GET ") + paths[any(paths.size())] +
                (any(2) == 0 ? "%" + std::to_string(any(99)) : "..%2f") + " HTTP/1.1\r\nHost: " + studio.host +
                "\r\nOrigin: http://" + studio.host + "\r\nCookie: " + studio.cookie + "\r\n";
      if (any(5) == 0) request += noise(200) + "\r\n";
      if (post)
        request += any(6) == 0
                       ? "Transfer-Encoding: chunked\r\n"
                       : "Content-Length: " + std::to_string(any(8) == 0 ? any(1u << 20) : body.size()) + "\r\n";
      request += "\r\n" + body;
      for (std::size_t faults = any(3); faults > 0; --faults)
        request[any(request.size())] = static_cast<char>(any(256));
    }
    answered += studio.raw(request, kPatience_ms).status != 0 ? 1 : 0;
    if (!studio.is_running()) FAIL() << "request " << i;
  }
  EXPECT_TRUE(studio.is_running());
  EXPECT_GT(answered, count / 4);
  EXPECT_EQ(studio.get("/studio.css").status, 200);
  EXPECT_EQ(file_text(folder / "hum/design.json"), design);
  EXPECT_FALSE(fs::exists(folder / "hum/round-01/board.gcode"));
  EXPECT_EQ(folder.file_count(), 1U) << "nothing is written beside the project";
}

// Somebody who clicks the main button of each place gets from pictures to G-code.
TEST(Studio, LeadsFromPicturesToGcodeInABrowser) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  const TemporaryFolder folder;
  StudioUnderTest studio(folder / "hum", {"--lan", "127.0.0.2"});
  const std::string phone = studio.next_address();
  Chromium browser(folder);
  const auto until = [&](const std::string& expression, int seconds) {
    for (int i = 0; i < 5 * seconds; ++i) {
      if (browser.evaluate(expression) == true) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return false;
  };
  const auto heading = [](const std::string& words) {
    return "document.querySelector('h1')?.textContent === '" + words + "'";
  };
  const auto click_main = [&] { browser.evaluate("document.getElementById('main').click()"); };
  // Every control has a name for a screen reader, and nothing is wider than the window.
  const auto check_page = [&](const std::string& place) {
    for (const int width : {1280, 390}) {
      browser.resize(width, 844);
      EXPECT_EQ(browser.evaluate("[...document.querySelectorAll('button, a, input, select, [role=button]')].filter(e "
                                 "=> !(e.textContent.trim() || "
                                 "e.getAttribute('aria-label') || e.labels?.length)).map(e => e.outerHTML)"),
                Chromium::Json::array())
          << place;
      EXPECT_EQ(browser.evaluate("[...document.images].filter(e => !e.hasAttribute('alt')).length"), 0) << place;
      EXPECT_LE(browser.evaluate("document.documentElement.scrollWidth").get<int>(), width) << place;
      EXPECT_EQ(browser.evaluate("document.querySelectorAll('main .main').length"), 1) << place << ": one main button";
    }
    if (const char* shots = std::getenv("BURIN_STUDIO_SCREENSHOTS"))
      for (const int width : {1280, 390}) {
        browser.resize(width, 844);
        browser.screenshot(std::string(shots) + "/" + place + "-" + std::to_string(width) + ".png");
      }
    browser.resize(1280, 844);
  };
  browser.open_address(studio.address, 1280, 844);
  ASSERT_TRUE(until(heading("Which pictures shall the metal show?"), 20));
  const std::string sample = places::source() + "/samples/small-bench/targets/";
  browser.choose_files("input[type=file]", {sample + "moon.png", sample + "boat.png", sample + "still-life.png"});
  ASSERT_TRUE(until("document.querySelectorAll('.card').length === 3", 30));
  check_page("pictures");
  click_main();
  ASSERT_TRUE(until(heading("This is how your pictures lie on the board."), 60));
  check_page("made");
  click_main();
  ASSERT_TRUE(until(heading("Where are the lamp and the eyes?"), 10));
  check_page("place");
  // By the keyboard: the lamp 10 mm further up.
  browser.evaluate("document.querySelector('.setup .handle').focus()");
  browser.press("ArrowUp");
  ASSERT_TRUE(until("fetch('/api/state?seen=0').then(r => r.json()).then(s => s.project.former === 1)", 10));
  click_main();
  ASSERT_TRUE(until(heading("Let Burin search the scratches."), 10));
  browser.evaluate(
      "for (const [name, value] of Object.entries({count: '300', pixels: '48', iterations: '10', travel: 'unknown'})) {"
      " const input = document.getElementById('wish-' + name); input.value = value; input.dispatchEvent(new "
      "Event('change')); }");
  click_main();
  ASSERT_TRUE(until(heading("The design is ready."), 120));
  ASSERT_TRUE(until("document.querySelectorAll('.pair').length === 3", 20));
  check_page("design");
  click_main();
  ASSERT_TRUE(until(heading("Read the check, then carve."), 10));
  ASSERT_TRUE(until("document.querySelector('canvas') !== null", 10)) << "the tool's way";
  check_page("carve");
  EXPECT_EQ(browser.evaluate("fetch(document.getElementById('main').href).then(r => r.text())"),
            file_text(folder / "hum/round-01/board.gcode"));
  browser.evaluate("[...document.querySelectorAll('#steps button')].at(-1).click()");
  ASSERT_TRUE(until(heading("Photograph the board."), 10));
  ASSERT_TRUE(until("document.querySelector('main').textContent.includes('camera')", 30))
      << "the judge of photos tells the next shot";
  check_page("look");
  EXPECT_THAT(browser.complaints(), ::testing::IsEmpty());

  browser.open_address(phone, 390, 844);
  ASSERT_TRUE(until("document.querySelector('.take') !== null", 20));
  EXPECT_EQ(browser.evaluate("fetch('/api/state?seen=0').then(r => r.status)"), 404) << "a phone sees shots alone";
  EXPECT_EQ(browser.evaluate("fetch('/api/do', {method: 'POST', body: '{}'}).then(r => r.status)"), 404);
}

TEST(Studio, PageIsSmallAndHasTwoLanguages) {
  std::size_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(places::source() + "/tools/studio"))
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") bytes += fs::file_size(entry.path());
  EXPECT_LT(bytes, 1'500'000U);
  // Each key of one language is a key of the other.
  const std::string words = file_text(places::source() + "/tools/studio/words.js");
  const std::size_t german = words.find("\n  de: {");
  ASSERT_NE(german, std::string::npos);
  const auto keys = [](const std::string& text) {
    std::vector<std::string> found;
    const std::regex key(R"(([a-zA-Z_]+): ")");
    for (std::sregex_iterator i(text.begin(), text.end(), key), end; i != end; ++i) found.push_back((*i)[1]);
    std::sort(found.begin(), found.end());
    return found;
  };
  EXPECT_EQ(keys(words.substr(0, german)), keys(words.substr(german)));
}

}  // namespace
}  // namespace burin
