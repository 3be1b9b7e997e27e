// consumer.cpp - as consumer.c, in C++11 and its library.
#define HBIL_IMPLEMENTATION
#include "hbil.h"
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

std::string emit(const hbil_plan &plan, int32_t pass)
{
    std::size_t need = 0;
    hbil_emit_glsl(&plan, pass, nullptr, 0, &need);
    std::vector<char> text(need);
    if (hbil_emit_glsl(&plan, pass, text.data(), text.size(), nullptr) != HBIL_OK) throw std::runtime_error("no text");
    return text.data();
}

} // namespace

int main(int argc, char **argv) try
{
    std::ifstream file(argc == 2 ? argv[1] : "");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    hbil_config config = {};
    std::unique_ptr<hbil_plan> plan(new hbil_plan);
    if (hbil_config_parse(&config, text.data(), text.size(), nullptr) != HBIL_OK) throw std::runtime_error("no config");
    if (hbil_plan_build(&config, plan.get(), nullptr) != HBIL_OK) throw std::runtime_error("no plan");
    std::cout << std::hex << std::setfill('0') << "hash " << std::setw(16) << plan->hash << '\n';
    for (int32_t pass = 0; pass < static_cast<int32_t>(plan->pass_count); ++pass) {
        uint32_t sum = 2166136261u;
        const std::string glsl = emit(*plan, pass);
        for (const char letter : glsl) sum = (sum ^ static_cast<unsigned char>(letter)) * 16777619u;
        std::cout << "pass " << plan->passes[pass].name << ' ' << std::dec << glsl.size() << ' ';
        std::cout << std::hex << std::setw(8) << sum << '\n';
    }
    return 0;
} catch (const std::exception &fault) {
    std::cerr << fault.what() << '\n';
    return 1;
}
