; Start-up and main loop.
;
; The loop polls in turn: the byte going out, the tick, one byte that came in. Nothing in it waits
; longer than the words to the DDS chips take (60 us), so the tick is never more than that late.

        include "board.inc"

        extern  uart_init, uart_poll_line, uart_take_byte, line_left
        extern  framing_init, framing_byte, commands_init, execute
        extern  dds_init, tick_init, tick_poll, faults_init, faults_poll

reset_vector code 0x0000
        goto    start

start_code code
start:
        movlw   LATC_START              ; latches before directions: the power stage stays off
        movwf   LATC
        movlw   TRISC_RUN
        movwf   TRISC
        clrf    LATB
        movlw   TRISB_RUN
        movwf   TRISB
        movlw   0x0F                    ; every analogue input is a digital pin
        movwf   ADCON1
        clrf    BSR
        clrf    INTCON
        call    faults_init
        call    commands_init
        call    framing_init
        call    dds_init
        call    tick_init
        call    uart_init
        bsf     INTCON, PEIE
        bsf     INTCON, GIE

main:
        call    uart_poll_line
        call    tick_poll
        call    faults_poll
        tstfsz  line_left               ; the next request waits until its reply's buffer is free
        bra     main
        call    uart_take_byte
        bnc     main
        call    framing_byte
        bnc     main
        call    execute
        bra     main

        end
