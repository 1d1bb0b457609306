; UART at 115200 8N1: the interrupt fills a ring, the main loop empties it and feeds the
; transmitter. Interrupt time is bounded: at most one byte and one tick.

        include "board.inc"

        global  uart_init, uart_poll_line, uart_take_byte, line_send, line_left, uart_overrun
        extern  tick_interrupt

uart_vars udata_acs
ring_tail       res     1       ; next byte to take; the head is FSR2L
line_index      res     1       ; next byte to send
line_left       res     1       ; bytes still to send
uart_overrun    res     1       ; not 0: bytes were lost

interrupt_vector code 0x0008
interrupt:
        btfss   PIR1, RCIF
        bra     no_byte
        btfsc   RCSTA, OERR
        bra     overrun
        movff   RCREG, INDF2
        incf    FSR2L, W
        xorwf   ring_tail, W
        bz      ring_full
        incf    FSR2L, F
no_byte:
        btfsc   PIR1, TMR2IF
        call    tick_interrupt
        retfie  FAST
overrun:
        bcf     RCSTA, CREN             ; the only way to clear OERR
        bsf     RCSTA, CREN
ring_full:
        setf    uart_overrun
        bra     no_byte

uart_code code
uart_init:
        clrf    ring_tail
        clrf    line_left
        clrf    uart_overrun
        lfsr    FSR2, RING_BANK << 8
        movlw   (1 << BRG16)
        movwf   BAUDCON
        clrf    SPBRGH
        movlw   BAUD_DIVISOR
        movwf   SPBRG
        movlw   (1 << TXEN) | (1 << BRGH)
        movwf   TXSTA
        movlw   (1 << SPEN) | (1 << CREN)
        movwf   RCSTA
        bsf     PIE1, RCIE
        return

; Take one byte from the ring: C set and the byte in W, or C clear.
uart_take_byte:
        bcf     STATUS, C
        movf    ring_tail, W
        xorwf   FSR2L, W
        bz      nothing
        movff   ring_tail, FSR0L
        movlw   RING_BANK
        movwf   FSR0H
        incf    ring_tail, F
        movf    INDF0, W
        bsf     STATUS, C
nothing:
        return

; Start sending the W bytes at the beginning of LINE_BANK.
line_send:
        movwf   line_left
        clrf    line_index
        return

; Feed the transmitter. TRMT rather than TXIF: it also says that the stop bit is out.
uart_poll_line:
        tstfsz  line_left
        btfss   TXSTA, TRMT
        return
        lfsr    FSR0, LINE_BANK << 8
        movf    line_index, W
        movff   PLUSW0, TXREG
        incf    line_index, F
        decf    line_left, F
        return

        end
