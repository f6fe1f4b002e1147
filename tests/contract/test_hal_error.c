/* hal_error.h: success is zero, errors are negative and can be told apart. */
#include "hal_error.h"
#include "unity.h"

static const int ERRORS[] = {HAL_ERR_CHANNEL, HAL_ERR_CONFIG, HAL_ERR_BUSY};
#define ERROR_COUNT (sizeof ERRORS / sizeof *ERRORS)

void setUp(void)
{
}

void tearDown(void)
{
}

void test_success_is_zero_and_errors_are_negative(void)
{
    TEST_ASSERT_EQUAL_INT(0, HAL_OK);
    for (size_t i = 0u; i < ERROR_COUNT; ++i) {
        TEST_ASSERT_LESS_THAN_INT(0, ERRORS[i]);
    }
}

void test_errors_can_be_told_apart(void)
{
    for (size_t i = 0u; i < ERROR_COUNT; ++i) {
        for (size_t j = 0u; j < i; ++j) {
            TEST_ASSERT_NOT_EQUAL_INT(ERRORS[i], ERRORS[j]);
        }
    }
}
