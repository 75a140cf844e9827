# foldcut: `make demo` to see it work, `make test` to see that it does. Needs python3 >= 3.11 and make.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CODE := foldcut exporters profiles samples tests

.PHONY: demo test bench bench-compact bench-skeleton bench-start bench-page bench-redraw bench-outlines bench-dihedral fuzz sweep sweep-compact sweep-skeleton sweep-icons page pictures screenshots lint tools clean

## Fold five drawings out of A4 into out/: a fish, a star that folds in five lines, a letter with a hole, a letter with curves
## that is drawn anew so that it folds, and a snowflake along its mirror axes.
demo: $(VENV)/installed
	@mkdir -p out
	$(BIN)/foldcut compile
	$(BIN)/foldcut make samples/fish.svg --sheet a4 --margin 25mm -o out/fish.svg -o out/fish.fold --force
	$(BIN)/foldcut make samples/star.svg --sheet a4 -o out/star.svg -o out/star.fold --force
	$(BIN)/foldcut make samples/letter-a.svg --sheet a4 -o out/letter-a.svg -o out/letter-a.fold --force
	$(BIN)/foldcut make docs/drawings/s.svg --sheet a4 -o out/s.svg -o out/s.fold --force
	$(BIN)/foldcut make docs/drawings/snowflake.svg --sheet a4 -o out/snowflake.svg -o out/snowflake.fold --force

## Run all tests; those that need a program which is not installed say so and skip.
test: $(VENV)/installed-test tools
	$(BIN)/foldcut compile
	$(BIN)/python -m pytest -n 2 --dist worksteal

## How packing, whole patterns, verification and exporters grow from 1e2 to LARGEST boundary disks, against what others
## take: out/bench.md, .json, .svg. Nothing here can fail for being slow; each may take LIMIT seconds or ends there.
LARGEST ?= 1e5
LIMIT ?= 12
bench: $(VENV)/installed-bench
	$(BIN)/python tests/bench/bench.py --largest $(LARGEST) --limit $(LIMIT) --out out

## Creases of the default and the paper's method for every sample, and for every shape in the folder SHAPES and below.
bench-compact: $(VENV)/installed-test
	$(BIN)/python tests/bench/compact.py $(SHAPES)

## The straight skeleton beside CGAL's and two in Python, how it grows to LARGEST corners, and the patterns made from it, for
## every sample and every shape in SHAPES, beside the skeleton.tsv of another version, BESIDE: out/skeleton.md and .tsv.
bench-skeleton: $(VENV)/installed-bench $(VENV)/installed-test
	$(BIN)/python tests/bench/skeleton.py --largest $(LARGEST) --out out \
		$(if $(SHAPES),--shapes $(SHAPES)) $(if $(BESIDE),--beside $(BESIDE))

## What is imported, and how long it takes, for --help and for a whole pattern.
bench-start: $(VENV)/installed-test
	$(BIN)/python tests/bench/start.py

## The page of a pattern of a thousand creases in Chromium: bytes, first picture, frames a second.
bench-page: $(VENV)/installed-test tools
	$(BIN)/python tests/bench/page.py

## Fold 500 random polygons by the compact method; takes about three minutes.
sweep-compact: $(VENV)/installed-test
	FOLDCUT_RANDOM_COMPACT=500 $(BIN)/python -m pytest -n 2 -k random_polygons_are_folded tests/methods/compact/test_search.py

## Fold 300 random polygons in six positions and sizes each; takes about an hour.
sweep: $(VENV)/installed-test
	FOLDCUT_RANDOM=300 $(BIN)/python -m pytest -n 2 -k random_polygons_are_verified tests/test_pipeline.py

## Straight skeletons of 5,000 random graphs, of the samples and of all shapes in the folder SHAPES and below, against a
## judge, an oracle and CGAL; takes about ten minutes.
sweep-skeleton: $(VENV)/installed-test
	FOLDCUT_RANDOM_SKELETON=5000 FOLDCUT_SHAPES=$(SHAPES) $(BIN)/python -m pytest -n 2 tests/geometry/straight_skeleton

## Fold 200 silhouettes out of icon sets with at most 60 corners each; takes about four minutes.
sweep-icons: $(VENV)/installed-test tools
	$(BIN)/python tests/bench/icons.py

## Icons and letters as people bring them, by the default command: how many are for two hands, and how soon; a prototype's
## table beaten; samples and the shapes in SHAPES never worse than before: out/redraw.md, .json. SHARE=1/4 takes a fourth.
bench-redraw: $(VENV)/installed-test
	$(BIN)/foldcut compile
	$(BIN)/python tests/bench/redraw.py --out out $(if $(SHAPES),--shapes $(SHAPES)) $(if $(SHARE),--share $(SHARE))

## How many outlines the search for outlines assesses in a second, beside the way of its prototype: out/outlines.json.
bench-outlines: $(VENV)/installed-test
	$(BIN)/python tests/bench/outlines.py --out out

## Folds of 60 random stars, snowflakes and rosettes with 3 to 12 mirror axes, beside what they may take.
bench-dihedral: $(VENV)/installed-test
	$(BIN)/python tests/bench/dihedral.py

## Fuzz each reader for SECONDS, five minutes by default; fuzz one with READERS=svg. What is found is in out/fuzz, and the
## inputs that reached something new, from which the next run goes on.
READERS ?= svg css dxf pdf geojson wkt wkb csv json image text fold cp opx creases values
SECONDS ?= 300
fuzz: $(VENV)/installed-fuzz
	@found=0; for reader in $(READERS); do \
		$(BIN)/python tests/fuzz/run.py $$reader --seconds $(SECONDS) || found=1; done; exit $$found

## Check style and types.
lint: $(VENV)/installed-dev
	$(BIN)/ruff check $(CODE)
	$(BIN)/ruff format --check $(CODE)
	$(BIN)/mypy

## Draw the pictures in docs/ anew.
KITE = $(BIN)/foldcut draw kite --sheet 180x200mm --margin 50mm --method paper --force --quiet
TRIANGLE = $(BIN)/foldcut draw triangle --sheet 200x180mm --margin 55mm --method paper --ribbon 3mm --force --quiet
pictures: $(VENV)/installed
	$(BIN)/foldcut compile
	$(BIN)/foldcut make fish --margin 25mm -o docs/fish.svg --force
	$(BIN)/foldcut make star -o docs/star.svg --force
	$(BIN)/foldcut make marlin -o docs/marlin.svg --force
	$(BIN)/foldcut make letter-a -o docs/letter-a.svg --force
	$(BIN)/foldcut draw docs/drawings/s.svg --show outline,pattern -o docs/s.svg --force
	$(BIN)/foldcut make docs/drawings/snowflake.svg -o docs/snowflake.svg --force
	$(BIN)/foldcut make snowflake -o docs/snowflake-wedge.svg --force
	$(BIN)/foldcut make rosette -o docs/rosette.svg --force
	$(BIN)/foldcut make paper-chain -o docs/paper-chain.svg --force
	$(BIN)/foldcut draw tangram --show pattern,pieces -o docs/tangram.svg --force
	$(BIN)/foldcut draw spiders-web --show pattern,pieces -o docs/spiders-web.svg --force
	$(BIN)/foldcut draw slit-card --show pattern,pieces -o docs/slit-card.svg --force
	$(BIN)/python docs/drawings/machines.py
	$(KITE) --show packing -o docs/figure-1.svg
	$(TRIANGLE) --show rabbit-ear -o docs/figure-2.svg
	$(TRIANGLE) --show gusset -o docs/figure-3.svg
	$(TRIANGLE) --show inset -o docs/figure-4.svg
	$(KITE) --show trees -o docs/figure-5a.svg
	$(KITE) --show matching -o docs/figure-5b.svg
	$(KITE) --ribbon 3mm --show ribbon -o docs/figure-7.svg

## Take the pictures of the page and of foldcut serve in docs/ anew.
screenshots: $(VENV)/installed-test tools
	$(BIN)/python tests/screenshots.py

## Bundle the page of foldcut view and foldcut serve: exporters/pattern/page.js and page.css, from page/src and three.js.
page:
	cd page && npm ci --silent --no-audit --no-fund && npm run --silent build

## Install the programs that are not ours and that read our files in the tests.
tools:
	@bash tests/tools.sh

## Remove what was built and installed.
clean:
	rm -rf $(VENV) out build dist tests/node/node_modules page/node_modules

$(VENV)/python-ok:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "foldcut needs Python 3.11 or newer; try: make PYTHON=python3.11"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/installed: $(VENV)/python-ok pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/installed-test: $(VENV)/python-ok pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@

$(VENV)/installed-fuzz: $(VENV)/python-ok pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[fuzz]'
	@touch $@

$(VENV)/installed-bench: $(VENV)/python-ok pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	@touch $@

# All that installed-test has, and more.
$(VENV)/installed-dev: $(VENV)/python-ok pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,dev]'
	@touch $@ $(VENV)/installed-test
