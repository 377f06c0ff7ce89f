// SPDX-License-Identifier: MIT
// A program of somebody who reads the configuration of a network, which is JSON.
#include <genrender/reference.hpp>

#include <iostream>

int main() {
    auto const json = genrender::reference::checked_json(R"({"sample_size": 64})", "config.json", "file", "an object");
    std::cout << "sample_size " << json["sample_size"] << '\n';
    return json["sample_size"] == 64 ? 0 : 1;
}
