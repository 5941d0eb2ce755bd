// SPDX-License-Identifier: MIT
#include "harness/report/page.h"

#include "harness/report/assets.h"
#include "scenes/error.h"
#include "scenes/recording/file.h"

#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <stdexcept>

namespace tandem::report {

namespace {

constexpr std::string_view chart_library = "chart.min.js";
constexpr std::array scene_libraries{"three.min.js", "OrbitControls.js"};

void replace_all(std::string& text, std::string_view what, std::string_view by) {
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
}

void replace_once(std::string& text, std::string_view what, std::string_view by) {
    const auto at = text.find(what);
    if (at == std::string::npos) throw std::logic_error(fmt::format("page.html has no {}", what));
    text.replace(at, what.size(), by);
}

std::string escaped_text(std::string text) {
    replace_all(text, "&", "&amp;");
    replace_all(text, "<", "&lt;");
    return text;
}

/// No text of a record can end its element.
std::string data_element(const std::string& id, std::string json) {
    replace_all(json, "<", "\\u003c");
    return fmt::format("<script type=\"application/json\" id=\"data-{}\">{}</script>\n", id, json);
}

std::string script_element(std::string_view name) {
    std::string script(asset(name));
    replace_all(script, "</script", "<\\/script");
    replace_all(script, "<!--", "<\\!--");
    return fmt::format("<script>\n{}\n</script>\n", script);
}

std::vector<std::string_view> scripts_of(const Page& page) {
    std::vector<std::string_view> scripts;
    if (page.has_charts) scripts.push_back(chart_library);
    if (page.has_scene) scripts.insert(scripts.end(), scene_libraries.begin(), scene_libraries.end());
    scripts.push_back("data.js");
    if (page.has_charts)
        for (const auto* name : {"words.js", "tables.js", "charts.js", "figures.js"}) scripts.push_back(name);
    if (page.has_scene)
        for (const auto* name : {"scene.js", "scene_controls.js"}) scripts.push_back(name);
    scripts.push_back("page.js");
    return scripts;
}

} // namespace

void check_libraries(const Page& page) {
    for (const auto name : scripts_of(page))
        if (asset(name).empty())
            throw InputError(
                fmt::format("this program was built without {}, which the page needs: install {} (Debian), "
                            "then configure and build anew",
                            name, name == chart_library ? "libjs-chart.js" : "libjs-three"));
}

std::string html_of(const Page& page) {
    std::string scripts;
    for (const auto& [id, json] : page.data) scripts += data_element(id, json);
    for (const auto name : scripts_of(page)) scripts += script_element(name);
    std::string html(asset("page.html"));
    replace_once(html, "/*styles*/", asset("page.css"));
    replace_all(html, "<!--title-->", escaped_text(page.title));
    replace_once(html, "<!--scripts-->", scripts);
    return html;
}

std::size_t empty_bytes(Page page) {
    page.data.clear();
    return html_of(page).size();
}

void write_page(const std::string& path, const std::string& html) {
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
        throw OutputError(fmt::format("{}: is no file that could be replaced; choose another with -o", path));
    try {
        recording::replace_whole(path, html);
    } catch (const InputError& error) {
        throw OutputError(error.what());
    }
}

} // namespace tandem::report
