# The front door: packages, configure, build, run. CMake is the build; nothing here is needed to use hbil.h.

BUILD    ?= build
JOBS     ?= $(shell nproc 2>/dev/null || echo 2)
PACKAGES ?= sh packages.sh
CMAKE    ?= cmake
CTEST    ?= ctest
FUZZ_SECONDS ?= 60

# Ninja where it is, but never another generator than the one a build folder began with. Asked after the packages are in.
CONFIGURE = $(CMAKE) -S . -B $(BUILD) $$(test -e $(BUILD)/CMakeCache.txt || ! command -v ninja >/dev/null || echo -G Ninja)
COMPILE   = $(CMAKE) --build $(BUILD) --parallel $(JOBS)

.PHONY: help demo viewer test embed bench report record table marches fuzz fuzz-long bounds long-run leaks mutate clean

help:
	@echo 'make demo    install lacking Debian packages, build, light a scene on Vulkan and GL; pictures and a table in out/demo'
	@echo 'make viewer  install lacking Debian packages, build hbil-viewer, a renderer with a window; says how to run it'
	@echo 'make test    install lacking Debian packages, build, run every test; the last line counts passed, failed, skipped'
	@echo 'make embed   write options.def, passes.def and glsl/ of shadergen/ into hbil.h and README.md'
	@echo 'make bench   how long plans, texts, SPIR-V and compiling the header take, and how large they are'
	@echo 'make report  speed against accuracy, statements, peers: tables and plots in out/report; an hour; HBIL_CAPTURES=DIR adds captures'
	@echo 'make record  the same, into examples/tradeoff/report, from where README and tests have their figures; wants HBIL_CAPTURES=DIR'
	@echo 'make table   errors and times of every preset on every capture, into README.md; minutes; wants HBIL_CAPTURES=DIR'
	@echo 'make marches errors and times of every march, side by side, into README.md; minutes; wants HBIL_CAPTURES=DIR'
	@echo 'make fuzz-long random configs on random frames, 100 million pixels on Vulkan and GL; an hour; cases of failures in out/search; HBIL_SEED=N'
	@echo 'make fuzz    libFuzzer on every input that comes from outside; FUZZ_SECONDS=N each ($(FUZZ_SECONDS)), FUZZ_TARGETS="config exr ..."'
	@echo 'make bounds  rounding errors of each output at the ends of distance, field of view, reach and slices, into README.md'
	@echo 'make long-run 36000 frames of a moving camera on both backends, six configs: no drift, no leak, no NaN; a quarter of an hour'
	@echo 'make leaks   all programs under sanitizers and valgrind, on both backends; minutes'
	@echo 'make mutate  each guard of the shaders taken out in turn: which test fails? Into tests/mutation/guards.md; minutes'
	@echo 'make clean   remove the build folders and out/demo'
	@echo
	@echo 'JOBS=N       that many at once, instead of $(JOBS)'
	@echo 'BUILD=DIR    build in DIR, instead of $(BUILD)'
	@echo 'PACKAGES=:   leave the packages alone'
	@echo
	@echo 'To build with CMake alone: cmake --preset default && cmake --build --preset default && ctest --preset default'
	@echo '(other presets: debug, sanitize)'

# The tests need more packages than the demo. A folder that was made for them stays so, or CMake would clear its programs away.
demo:
	@$(PACKAGES) build
	$(CONFIGURE) $$(test -e $(BUILD)/CMakeCache.txt || echo -DHBIL_BUILD_TESTS=OFF)
	$(COMPILE) --target hbil-frame shadergen
	@sh examples/frame/demo.sh $(BUILD)/bin/hbil-frame out/demo

viewer:
	@$(PACKAGES) test
	$(CONFIGURE) $$(test -e $(BUILD)/CMakeCache.txt || echo -DHBIL_BUILD_TESTS=OFF)
	$(COMPILE) --target hbil-viewer
	@echo; echo 'now:          $(BUILD)/bin/hbil-viewer --model examples/viewer/room.gltf'
	@echo 'or, unseen:   $(BUILD)/bin/hbil-viewer --headless --frames 16 --set temporal=yes --png out/viewer/'

# LP_NUM_THREADS balances Mesa's software rasterisers; GPUs do not read it. Counted from the single results: the sums of
# ctest's own file call a test "skipped" whose program is missing. Its exit code is kept.
test:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE)
	@rm -f $(BUILD)/tests.xml; code=0; \
	LP_NUM_THREADS=$${LP_NUM_THREADS:-16} $(CTEST) --test-dir $(BUILD) --output-on-failure --no-tests=error \
	    --parallel $(JOBS) --output-junit tests.xml || code=$$?; \
	test -e $(BUILD)/tests.xml || { echo 'make test: ctest left no results'; exit 1; }; \
	echo; \
	awk '/<testcase /                               { ++all } \
	     /<testcase .* status="run"/                { ++passed } \
	     /<testcase .* status="disabled"/           { ++skipped } \
	     /^[ \t]*<skipped message="SKIP_/           { ++skipped } \
	     END { print passed + 0 " passed, " all - passed - skipped " failed, " skipped + 0 " skipped" }' $(BUILD)/tests.xml; \
	exit $$code

embed:
	@$(PACKAGES) build
	$(CONFIGURE) $$(test -e $(BUILD)/CMakeCache.txt || echo -DHBIL_BUILD_TESTS=OFF)
	$(COMPILE) --target embed

bench:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-bench
	@$(BUILD)/bin/hbil-bench
	@sh tests/bench/compile.sh

report:
	@$(PACKAGES) test && $(PACKAGES) peers
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-tradeoff hbil-peers
	@sh examples/tradeoff/report.sh $(BUILD)/bin out/report

record:
	@test -n "$$HBIL_CAPTURES" || { echo 'make record: set HBIL_CAPTURES to the folder of the captures'; exit 2; }
	@$(MAKE) report
	mkdir -p examples/tradeoff/report && cp out/report/*.md out/report/*.csv out/report/*.svg examples/tradeoff/report/

table:
	@test -n "$$HBIL_CAPTURES" || { echo 'make table: set HBIL_CAPTURES to the folder of the captures'; exit 2; }
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-table
	@$(BUILD)/bin/hbil-table "$$HBIL_CAPTURES" --out README.md

marches:
	@test -n "$$HBIL_CAPTURES" || { echo 'make marches: set HBIL_CAPTURES to the folder of the captures'; exit 2; }
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-marches
	@LP_NUM_THREADS=$${LP_NUM_THREADS:-16} $(BUILD)/bin/hbil-marches --out README.md

mutate:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-mutate
	@$(BUILD)/bin/hbil-mutate

# What test "search" does for seconds. PIXELS=N: fewer or more.
fuzz-long:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-search
	@mkdir -p out
	@LP_NUM_THREADS=$${LP_NUM_THREADS:-16} $(BUILD)/bin/hbil-search --pixels $(or $(PIXELS),100000000) --failures 100 \
	    --backend vulkan,vulkan,gl --out out/search

# Its programs want clang, so a folder of their own. See tests/fuzz/README.md.
fuzz:
	@$(PACKAGES) test
	$(CMAKE) -S . -B build-fuzz -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DHBIL_BUILD_TESTS=ON -DHBIL_FUZZ=ON
	$(CMAKE) --build build-fuzz --parallel $(JOBS) --target fuzz
	@sh tests/fuzz/run.sh $(CURDIR)/build-fuzz/bin $(CURDIR)/tests/fuzz/corpus $(CURDIR)/build-fuzz/fuzz-work $(FUZZ_SECONDS) $(FUZZ_TARGETS)

bounds:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-bounds
	@$(BUILD)/bin/hbil-bounds --out README.md

long-run:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target hbil-long-run
	@LP_NUM_THREADS=$${LP_NUM_THREADS:-2} $(BUILD)/bin/hbil-long-run

leaks:
	@$(PACKAGES) test
	$(CONFIGURE) -DHBIL_BUILD_TESTS=ON
	$(COMPILE) --target forgetful shadergen hbil-emit hbil-frame
	$(CMAKE) -S . -B build-sanitize -DCMAKE_BUILD_TYPE=Debug -DHBIL_SANITIZE=ON -DHBIL_BUILD_TESTS=ON \
	    $$(test -e build-sanitize/CMakeCache.txt || ! command -v ninja >/dev/null || echo -G Ninja)
	$(CMAKE) --build build-sanitize --parallel $(JOBS) --target forgetful shadergen hbil-frame hbil-viewer hbil-tradeoff hbil-long-run
	@sh tests/long/leaks.sh $(BUILD)/bin build-sanitize/bin

clean:
	rm -rf $(BUILD) build-debug build-sanitize build-fuzz out/demo
