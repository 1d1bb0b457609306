; Requests: what is refused, what is done, what is answered. PROTOCOL.md has the order of refusals.

        include "board.inc"

        global  commands_init, execute, forget_request
        extern  request, payload_length, request_crc, bad_frames, reply_start, reply_send, line_send
        extern  host_heard, flags, faults, reset_cause, silence_trips, fault_stop
        extern  dds_set_drive, dds_set_phase, new_frequency, new_phase, frequency_word, phase_word
        extern  dds_error, outputs_start, outputs_stop

TYPE            equ     1       ; offsets in `request`
PAYLOAD         equ     2

command_vars udata_acs
stored_length   res     1       ; acknowledgement of the last executed request; 0: none
stored_sequence res     1
stored_crc      res     2
reason          res     1
scratch         res     2

; Refuse with the reason where the payload has not this length.
expect_length macro length
        movlw   length
        cpfseq  payload_length
        bra     refuse_length
        endm

expect_identified macro
        btfsc   flags, FLAG_NOT_IDENTIFIED_BIT
        bra     refuse_not_identified
        endm

expect_no_fault macro
        btfsc   flags, FLAG_INTERNAL_FAULT_BIT
        bra     refuse_fault
        endm

; C set where the 32 bits at `value` are at least `limit`.
compare32 macro value, limit
        movlw   low (limit)
        subwf   value, W
        movlw   (limit) >> 8 & 0xFF
        subwfb  value + 1, W
        movlw   (limit) >> 16 & 0xFF
        subwfb  value + 2, W
        movlw   (limit) >> 24 & 0xFF
        subwfb  value + 3, W
        endm

; Into the reply.
put_byte macro value
        movlw   low (value)
        movwf   POSTINC1
        endm

put_u16 macro value
        put_byte value
        put_byte (value) >> 8
        endm

put_u32 macro value
        put_u16 value
        put_u16 (value) >> 16
        endm

copy_u16 macro variable
        movff   variable, POSTINC1
        movff   variable + 1, POSTINC1
        endm

copy_u32 macro variable
        copy_u16 variable
        copy_u16 variable + 2
        endm

command_code code
commands_init:
forget_request:
        clrf    stored_length
        return

; Answer the frame in `request`. A frame with the top bit of its type set is a reply, not for us.
execute:
        btfsc   request + TYPE, 7
        return
        call    host_heard
        movf    request + TYPE, W
        xorlw   REQUEST_IDENTIFY
        bz      identify
        rcall   is_repeat
        btfsc   STATUS, Z
        bra     answer_again
        movf    request + TYPE, W
        xorlw   REQUEST_SET_DRIVE
        btfsc   STATUS, Z
        bra     set_drive
        xorlw   REQUEST_SET_DRIVE ^ REQUEST_SET_PHASE
        btfsc   STATUS, Z
        bra     set_phase
        xorlw   REQUEST_SET_PHASE ^ REQUEST_OUTPUTS
        btfsc   STATUS, Z
        bra     outputs
        xorlw   REQUEST_OUTPUTS ^ REQUEST_STATUS
        btfsc   STATUS, Z
        bra     status
        xorlw   REQUEST_STATUS ^ REQUEST_HEARTBEAT
        btfsc   STATUS, Z
        bra     heartbeat
        movlw   REFUSAL_UNKNOWN_COMMAND
        bra     refuse

identify:
        expect_length IDENTIFY_REQUEST_LENGTH
        bcf     flags, FLAG_NOT_IDENTIFIED_BIT
        rcall   acknowledge
        put_byte PROTOCOL_VERSION
        put_byte FIRMWARE_MAJOR
        put_byte FIRMWARE_MINOR
        put_u32 DDS_CLOCK_HZ
        put_u32 FREQUENCY_WORD_MIN
        put_u32 FREQUENCY_WORD_MAX
        put_u16 PHASE_WORD_MIN
        put_u16 PHASE_WORD_MAX
        put_byte DDS_FREQUENCY_BITS
        put_byte DDS_PHASE_BITS
        put_u16 HOST_SILENCE_MS
        rcall   forget_request          ; the next session may count from the same number
        goto    reply_send

set_drive:
        expect_length SET_DRIVE_REQUEST_LENGTH
        expect_identified
        compare32 request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD, FREQUENCY_WORD_MIN
        btfss   STATUS, C
        bra     refuse_frequency
        compare32 request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD, FREQUENCY_WORD_MAX + 1
        btfsc   STATUS, C
        bra     refuse_frequency
        movff   request + PAYLOAD + SET_DRIVE_PHASE_WORD, new_phase
        movff   request + PAYLOAD + SET_DRIVE_PHASE_WORD + 1, new_phase + 1
        rcall   check_phase
        btfsc   STATUS, C
        bra     refuse_phase
        expect_no_fault
        movff   request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD, new_frequency
        movff   request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD + 1, new_frequency + 1
        movff   request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD + 2, new_frequency + 2
        movff   request + PAYLOAD + SET_DRIVE_FREQUENCY_WORD + 3, new_frequency + 3
        call    dds_set_drive
        tstfsz  dds_error
        bra     dds_differs
        bsf     flags, FLAG_CONFIGURED_BIT
        bra     acknowledge_flags

set_phase:
        expect_length SET_PHASE_REQUEST_LENGTH
        expect_identified
        movff   request + PAYLOAD + SET_PHASE_PHASE_WORD, new_phase
        movff   request + PAYLOAD + SET_PHASE_PHASE_WORD + 1, new_phase + 1
        rcall   check_phase
        btfsc   STATUS, C
        bra     refuse_phase
        expect_no_fault
        call    dds_set_phase
        bra     done

outputs:
        expect_length OUTPUTS_REQUEST_LENGTH
        movf    request + PAYLOAD + OUTPUTS_ON, W
        bz      outputs_off
        expect_identified
        xorlw   1
        btfss   STATUS, Z
        bra     refuse_value
        expect_no_fault
        btfss   flags, FLAG_CONFIGURED_BIT
        bra     refuse_not_configured
        bcf     flags, FLAG_HOST_SILENCE_BIT
        call    outputs_start
        bra     done
outputs_off:
        bcf     flags, FLAG_HOST_SILENCE_BIT
        call    outputs_stop
done:
        tstfsz  dds_error
        bra     dds_differs
acknowledge_flags:
        rcall   acknowledge
        bra     reply_remember

heartbeat:
        expect_length HEARTBEAT_REQUEST_LENGTH
        expect_identified
        bra     acknowledge_flags

status:
        expect_length STATUS_REQUEST_LENGTH
        rcall   acknowledge
        movff   reset_cause, POSTINC1
        movff   faults, POSTINC1
        copy_u32 frequency_word         ; both chips hold the same
        copy_u32 frequency_word
        put_u16 0                       ; generator A is the reference
        copy_u16 phase_word
        copy_u16 bad_frames
        movff   silence_trips, POSTINC1

; Send the acknowledgement and keep it for a repeat of this request.
reply_remember:
        call    reply_send
        movwf   stored_length
        movff   request, stored_sequence
        movff   request_crc, stored_crc
        movff   request_crc + 1, stored_crc + 1
        movwf   scratch
        lfsr    FSR0, LINE_BANK << 8
        lfsr    FSR1, STORED_BANK << 8
        bra     copy_reply
answer_again:
        movff   stored_length, scratch
        lfsr    FSR0, STORED_BANK << 8
        lfsr    FSR1, LINE_BANK << 8
        movf    scratch, W
        call    line_send
copy_reply:
        movff   POSTINC0, POSTINC1
        decfsz  scratch, F
        bra     copy_reply
        return

; Z set where the request is the one whose acknowledgement is stored.
is_repeat:
        movf    stored_length, F
        bz      not_a_repeat
        movf    request, W
        xorwf   stored_sequence, W
        bnz     differs
        movf    request_crc, W
        xorwf   stored_crc, W
        bnz     differs
        movf    request_crc + 1, W
        xorwf   stored_crc + 1, W
differs:
        return
not_a_repeat:
        bcf     STATUS, Z
        return

; Begin an acknowledgement: its type and the flags.
acknowledge:
        movf    request + TYPE, W
        iorlw   ACK_BIT
        call    reply_start
        movff   flags, POSTINC1
        return

; C set where `new_phase` is out of range.
check_phase:
        movlw   low (-PHASE_WORD_MIN)
        addwf   new_phase, W
        movwf   scratch
        movlw   high (-PHASE_WORD_MIN)
        addwfc  new_phase + 1, W
        movwf   scratch + 1
        movlw   low (PHASE_WORD_MAX - PHASE_WORD_MIN + 1)
        subwf   scratch, W
        movlw   high (PHASE_WORD_MAX - PHASE_WORD_MIN + 1)
        subwfb  scratch + 1, W
        return

dds_differs:
        movlw   (1 << FAULT_DDS_MISMATCH_BIT)
        call    fault_stop
refuse_fault:
        movlw   REFUSAL_INTERNAL_FAULT
        bra     refuse
refuse_length:
        movlw   REFUSAL_WRONG_LENGTH
        bra     refuse
refuse_not_identified:
        movlw   REFUSAL_NOT_IDENTIFIED
        bra     refuse
refuse_frequency:
        movlw   REFUSAL_FREQUENCY_OUT_OF_RANGE
        bra     refuse
refuse_phase:
        movlw   REFUSAL_PHASE_OUT_OF_RANGE
        bra     refuse
refuse_value:
        movlw   REFUSAL_BAD_VALUE
        bra     refuse
refuse_not_configured:
        movlw   REFUSAL_NOT_CONFIGURED
refuse:
        movwf   reason
        movf    request + TYPE, W
        iorlw   REFUSAL_BITS
        call    reply_start
        movff   reason, POSTINC1
        movff   flags, POSTINC1
        goto    reply_send

        end
