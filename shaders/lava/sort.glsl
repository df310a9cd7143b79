// A stable counting sort, seven bits of the keys at a time. One invocation follows a block of the list from its first item to
// its last, so that no atomic is needed and the order is the same in every run.

const uint DIGITS = 128u;
const uint BLOCK = 256u; // items
const uint RUN = 256u; // counts that are summed by one invocation

layout(push_constant, std430) uniform Sort {
    uint items;
    uint blocks;
    uint shift; // of the digit
    uint first_sum; // place of the sums of runs behind the counts
    uint second_sum; // place of the sums of runs of those
} sort;

layout(set = 0, binding = 0, std430) readonly buffer From {
    uvec2 list[]; // key and what is sorted
} from;

layout(set = 0, binding = 1, std430) buffer Counts {
    uint list[]; // digit by digit, of each digit block by block; then the sums of their runs
} counts;

uint digit_of(uint at) {
    return (from.list[at].x >> sort.shift) & (DIGITS - 1u);
}
