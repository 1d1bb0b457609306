; Faults: why the chip was reset, and what must never be.
;
; A fault that puts the drive in doubt stops it, empties the memory of the last request, and keeps
; it stopped until the next reset. Lost bytes are noted but cost a frame, not the drive.

        include "board.inc"

        global  faults_init, faults_poll, faults_check_state, fault_stop
        global  flags, faults, reset_cause, silence_trips
        extern  dds_error, dds_check_port, outputs_stop, forget_request, uart_overrun

; High/low-voltage detect at 4.44 V, falling: it sees the supply go before the brown-out reset.
SUPPLY_DETECT           equ     b'00011101'

fault_vars udata_acs
flags           res     1
faults          res     1
reset_cause     res     1
silence_trips   res     1
new_fault       res     1

fault_code code
faults_init:
        movlw   (1 << FLAG_NOT_IDENTIFIED_BIT)
        movwf   flags
        clrf    faults
        clrf    silence_trips
        rcall   find_reset_cause
        movwf   reset_cause
        xorlw   RESET_STACK
        bnz     stack_is_sound
        bsf     faults, FAULT_STACK_BIT
        bsf     flags, FLAG_INTERNAL_FAULT_BIT
stack_is_sound:
        movlw   (1 << RI) | (1 << POR) | (1 << BOR)
        iorwf   RCON, F                 ; so that the next reset shows its own cause
        bcf     STKPTR, STKFUL          ; the rest of STKPTR is the stack pointer itself
        bcf     STKPTR, STKUNF
        clrwdt                          ; sets TO and PD
        movlw   SUPPLY_DETECT
        movwf   HLVDCON
        bcf     PIR2, HLVDIF
        return

; W: cause of the reset. A power-on also leaves the brown-out bit at 0, so it is asked first.
find_reset_cause:
        btfss   RCON, POR
        retlw   RESET_POWER_ON
        btfss   RCON, BOR
        retlw   RESET_BROWN_OUT
        movf    STKPTR, W
        andlw   (1 << STKFUL) | (1 << STKUNF)
        bz      not_stack
        retlw   RESET_STACK
not_stack:
        btfss   RCON, TO
        retlw   RESET_WATCHDOG
        btfss   RCON, RI
        retlw   RESET_SOFTWARE
        retlw   RESET_EXTERNAL

; Each pass of the main loop.
faults_poll:
        tstfsz  uart_overrun
        bsf     faults, FAULT_UART_OVERRUN_BIT
        clrf    uart_overrun
        btfsc   PIR2, HLVDIF
        bra     supply_fell
        tstfsz  dds_error
        bra     dds_differs
        return
supply_fell:
        bcf     PIR2, HLVDIF
        btfss   HLVDCON, IVRST          ; the detector's reference is not steady yet
        return
        movlw   (1 << FAULT_BROWN_OUT_BIT)
        bra     fault_stop
dds_differs:
        movlw   (1 << FAULT_DDS_MISMATCH_BIT)
        bra     fault_stop

; Each tick: the pins and the flags must agree.
faults_check_state:
        call    dds_check_port
        bnz     state_differs
        return
state_differs:
        movlw   (1 << FAULT_STATE_BIT)

; Stop the drive for the fault in W.
fault_stop:
        iorwf   faults, F
        bsf     flags, FLAG_INTERNAL_FAULT_BIT
        movlw   LATC_START              ; where the pins themselves were changed, put them back
        movwf   LATC
        movlw   TRISC_RUN
        movwf   TRISC
        call    outputs_stop
        clrf    dds_error
        goto    forget_request

        end
