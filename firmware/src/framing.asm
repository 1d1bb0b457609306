; Frames: COBS(sequence, type, payload, CRC-16/IBM-3740) and a zero byte.
;
; Decoding keeps a byte counter and two bits of state, so that any byte stream is either a valid
; frame or one more bad one, and every zero byte starts afresh.

        include "board.inc"

        global  framing_init, framing_byte, reply_start, reply_send, request, payload_length
        global  request_crc, bad_frames
        extern  line_send

        if (CRC_POLYNOMIAL != 0x1021) || (CRC_INITIAL != 0xFFFF)
        error   "crc_byte is written out for the polynomial 0x1021"
        endif

STARTED         equ     0       ; a byte came since the last delimiter
BROKEN          equ     1       ; the frame is too long

framing_vars udata_acs
request         res     FRAME_MAX
request_length  res     1       ; decoded bytes so far
payload_length  res     1
request_crc     res     2       ; of the last valid frame
bad_frames      res     2
block_left      res     1       ; bytes until the next COBS code
decoder         res     1       ; STARTED, BROKEN
byte            res     1
crc             res     2
crc_x           res     1
crc_r           res     1
count           res     1
code_at         res     1
block_code      res     1

framing_code code
framing_init:
        clrf    bad_frames
        clrf    bad_frames + 1
frame_restart:
        clrf    request_length
        clrf    block_left
        clrf    decoder
        return

; Take the byte in W. C set: `request`, `payload_length` and `request_crc` hold a valid frame.
framing_byte:
        movwf   byte
        bz      frame_end
        tstfsz  block_left
        bra     data_byte
        decf    byte, W                 ; a COBS code: this many bytes follow before a zero
        movwf   block_left
        btfsc   decoder, STARTED        ; the zero that the block before stood for
        rcall   append_zero
        bsf     decoder, STARTED
        bcf     STATUS, C
        return
data_byte:
        decf    block_left, F
        rcall   append
        bcf     STATUS, C
        return

append_zero:
        clrf    byte
append:
        movlw   FRAME_MAX
        cpfslt  request_length
        bra     too_long
        lfsr    FSR0, request
        movf    request_length, W
        movff   byte, PLUSW0
        incf    request_length, F
        return
too_long:
        bsf     decoder, BROKEN
        return

frame_end:
        btfss   decoder, STARTED        ; two delimiters in a row are no frame
        bra     no_frame
        btfsc   decoder, BROKEN
        bra     bad_frame
        tstfsz  block_left              ; cut off within a block
        bra     bad_frame
        movlw   FRAME_OVERHEAD
        subwf   request_length, W
        bnc     bad_frame
        movwf   payload_length
        addlw   FRAME_OVERHEAD - 2
        lfsr    FSR0, request
        rcall   crc_of
        movf    INDF0, W                ; FSR0 is past the payload, at the CRC
        movwf   request_crc
        xorwf   crc, W
        bnz     bad_frame
        incf    FSR0L, F
        movf    INDF0, W
        movwf   request_crc + 1
        xorwf   crc + 1, W
        bnz     bad_frame
        rcall   frame_restart
        bsf     STATUS, C
        return

bad_frame:
        infsnz  bad_frames, F
        incf    bad_frames + 1, F
        movf    bad_frames, W
        iorwf   bad_frames + 1, W
        bnz     no_frame
        setf    bad_frames              ; stops at 65535
        setf    bad_frames + 1
no_frame:
        rcall   frame_restart
        bcf     STATUS, C
        return

; CRC of the W bytes at FSR0, which is left behind the last of them. W is not 0.
crc_of:
        movwf   count
        setf    crc
        setf    crc + 1
crc_next:
        movf    POSTINC0, W
        rcall   crc_byte
        decfsz  count, F
        bra     crc_next
        return

; One byte, without a table: x = high ^ byte; x ^= x >> 4;
; crc = (crc << 8) ^ (x << 12) ^ (x << 5) ^ x.
crc_byte:
        xorwf   crc + 1, W
        movwf   crc_x
        swapf   crc_x, W
        andlw   0x0F
        xorwf   crc_x, F
        swapf   crc_x, W
        andlw   0xF0
        xorwf   crc, W
        movwf   crc + 1
        rrncf   crc_x, W                ; x turned right by 3: x >> 3 and x << 5 in one byte
        movwf   crc_r
        rrncf   crc_r, F
        rrncf   crc_r, F
        movf    crc_r, W
        andlw   0x1F
        xorwf   crc + 1, F
        movf    crc_r, W
        andlw   0xE0
        xorwf   crc_x, W
        movwf   crc
        return

; Start a reply of type W to the request at hand; FSR1 is left where the payload goes.
reply_start:
        lfsr    FSR1, REPLY_BANK << 8
        movff   request, POSTINC1
        movwf   POSTINC1
        return

; Close the reply that ends at FSR1 and send it. W is left with its length on the line.
reply_send:
        movf    FSR1L, W
        lfsr    FSR0, REPLY_BANK << 8
        rcall   crc_of
        movff   crc, POSTINC1
        movff   crc + 1, POSTINC1
        movff   FSR1L, count
        lfsr    FSR0, REPLY_BANK << 8
        lfsr    FSR1, LINE_BANK << 8
new_block:
        movff   FSR1L, code_at          ; the code goes here once the block's length is known
        movlw   1
        movwf   block_code
        incf    FSR1L, F
encode_next:
        movf    count, F
        bz      encoded
        decf    count, F
        movf    POSTINC0, W
        bz      block_ends
        movwf   POSTINC1
        incf    block_code, F
        bra     encode_next
block_ends:
        rcall   put_code
        bra     new_block
encoded:
        rcall   put_code
        clrf    POSTINC1                ; the delimiter
        movf    FSR1L, W
        goto    line_send

put_code:
        movf    FSR1L, W
        movff   code_at, FSR1L
        movff   block_code, INDF1
        movwf   FSR1L
        return

        end
