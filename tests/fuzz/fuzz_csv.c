/* fuzz_csv.c - the CSV of a sweep, which hbil-tradeoff reads again. */
#include "fuzz.h"
#include "../../examples/tradeoff/csv.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    csv out;
    char error[512] = "";
    if (!ready) {
        fuzz_enter_folder();
        ready = 1;
    }
    fuzz_write("sweep.csv", data, size);
    if (csv_read(&out, "sweep.csv", error, sizeof error)) csv_free(&out);
    else FUZZ_REQUIRE(error[0] != 0);
    return 0;
}
