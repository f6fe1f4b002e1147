/* Runs a fuzz target once for each file named on the command line, without libFuzzer. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define INPUT_MAX_BYTES (1u << 20)

static int replay(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        return EXIT_FAILURE;
    }
    static uint8_t input[INPUT_MAX_BYTES];
    size_t         size = fread(input, 1u, sizeof input, file);
    (void)fclose(file);
    printf("%s: %zu bytes\n", path, size);
    /* A copy of its own size, so that the sanitizer sees a read past the end. */
    uint8_t *exact = malloc(size + (size == 0u));
    if (exact == NULL) {
        return EXIT_FAILURE;
    }
    for (size_t i = 0u; i < size; ++i) {
        exact[i] = input[i];
    }
    int outcome = LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    return outcome;
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) {
        if (replay(argv[i]) != 0) {
            return EXIT_FAILURE;
        }
    }
    return argc > 1 ? EXIT_SUCCESS : EXIT_FAILURE;
}
