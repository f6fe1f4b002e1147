/* The latch without a board: a touch whose contact bounces. Your port has these six functions. */
#include <skiplatch.h>
#include <stdio.h>

static bool deflected;

int hal_edge_arm(const hal_edge_config_t *config) { return config->channel == 0u ? HAL_OK : HAL_ERR_CHANNEL; }
void hal_edge_disarm(uint8_t channel) { (void)channel; }
bool hal_edge_level(uint8_t channel) { return channel == 0u && deflected; }
int32_t hal_axis_position_counts(uint8_t axis) { return axis == 0u ? 4711 : 0; }
hal_critical_state_t hal_critical_enter(void) { return 0u; }
void hal_critical_exit(hal_critical_state_t saved) { (void)saved; }

int main(void)
{
    skip_input_t input;
    latch_record_t record;
    skip_input_start(&input, &(skip_input_config_t){.edge.channel = 0u, .axis = 0u});
    latch_arm(&input.latch, &(latch_config_t){.confirm_ticks = 50u});
    deflected = true;
    skip_input_on_edge(&input, 1000u); /* what hal_edge_on_latch() hands on */
    skip_input_on_edge(&input, 1020u); /* the bounce */
    skip_input_poll(&input, 1100u);
    if (!latch_take(&input.latch, &record)) {
        return 1;
    }
    printf("touched at tick %lu, count %ld, bounces %u\n", (unsigned long)record.ticks,
           (long)record.position_counts, (unsigned)latch_counters(&input.latch).bounces);
    return 0;
}
