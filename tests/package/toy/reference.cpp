// SPDX-License-Identifier: MIT
// A program of somebody who reads the configuration of a network, which is JSON, and cuts a prompt into words.
#include <genrender/reference.hpp>

#include <iostream>

int main() {
    auto const json = genrender::reference::checked_json(R"({"sample_size": 64})", "config.json", "file", "an object");
    std::cout << "sample_size " << json["sample_size"] << '\n';
    auto const prompt = genrender::reference::clip_cleaned(U"A RED ball");
    return json["sample_size"] == 64 && genrender::reference::clip_words(prompt).size() == 3 ? 0 : 1;
}
