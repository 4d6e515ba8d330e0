/* Messages of devices whose other end is in the process that steps the board: CAN, network. */
#ifndef MESSAGES_H
#define MESSAGES_H

constexpr int CHANNELS = 3;

Received on_message[CHANNELS];
uint8_t message_channel, message[2048];
size_t message_size, message_whole;

void message_begin(uint8_t channel, uint16_t size)
{
    message_channel = channel % CHANNELS;
    message_size = 0;
    message_whole = size <= sizeof message ? size : 0;
}

void message_add(const link_input *input)
{
    size_t count = input->value <= 8 ? input->value : 0;
    if (message_size + count > message_whole)
        return;
    memcpy(message + message_size, &input->number, count);
    message_size += count;
    if (message_size == message_whole && on_message[message_channel])
        on_message[message_channel](message, message_size);
}

} // namespace

void receive_messages(int channel, Received handler) { on_message[channel] = handler; }

void send_message(int channel, const void *data, size_t size)
{
    const uint8_t *bytes = (const uint8_t *)data;
    link_put(OUT_MESSAGE, (uint8_t)channel, (uint16_t)size, now);
    for (size_t at = 0; at < size; at += 2)
        link_put(OUT_MORE, (uint8_t)channel, (uint16_t)(bytes[at] | (at + 1 < size ? bytes[at + 1] << 8 : 0)), now);
}

namespace {

#endif
