!> Tests. The tables of one instant as the listing must print them, from closed forms in real128: heads, rows, what does
!> not exist, masks. Nothing of the program's tables is used.
module hand_tables
   use mechanism, only: mechanism_t, instant_count, instant, request_pair
   use quad_jet, only: qp, degree_q
   use closed_forms_dyads, only: body_t
   use hand_scales, only: hand_scales_t
   use hand_numbers, only: number_by_hand, field_length
   use hand_rows, only: hand_row_t, row_by_hand
   use text_output, only: output_t, put
   implicit none
   private
   public :: put_tables

   integer, parameter :: name_length = 9, line_length = name_length + 9*field_length
   !> In English and in Polish.
   character(10), parameter :: instant_words(2) = [character(10) :: ' INSTANT ', ' CHWILA ']
   character(4), parameter :: none_words(2) = [character(4) :: 'NONE', 'BRAK']
   character(40), parameter :: unknown_words(2) = [character(40) :: 'DIGITS THAT ROUNDING LEAVES OPEN', &
      'CYFRY NIEPEWNE Z POWODU ZAOKRAGLEN']
   character(60), parameter :: singular_words(2) = [character(60) :: 'CHANGE POINT: VELOCITIES NOT UNIQUE', &
      'PUNKT ZMIANY: PREDKOSCI NIEJEDNOZNACZNE']
   !> The heads over links, points and pairs; their words end where the numbers do.
   character(line_length), parameter :: heads(3, 2) = reshape([character(line_length) :: &
      ' LINK               X           Y         PHI          VX          VY        VPHI' &
      //'          AX          AY        APHI', &
      ' POINT              X           Y                      VX          VY                      AX          AY', &
      ' PAIR           VALUE                                RATE                            2ND RATE', &
      ' OGNIWO             X           Y          FI          VX          VY         VFI' &
      //'          AX          AY         AFI', &
      ' PUNKT              X           Y                      VX          VY                      AX          AY', &
      ' PARA         WARTOSC                            PREDKOSC                             PRZYSP.'], [3, 2])

contains

   !> Instant number `step` of `m`, whose links are at `b`, in the order of the deck; `resting` (links): they have no
   !> velocity of their own; `error` (3, 0:2, requests), of size 0 where all digits are known.
   subroutine put_tables(o, m, scales, step, b, resting, error)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(hand_scales_t), intent(in) :: scales
      integer, intent(in) :: step
      type(body_t), intent(in) :: b(:)
      logical, intent(in) :: resting(:)
      real(qp), intent(in) :: error(:, 0:, :)
      type(hand_row_t) :: row
      character(line_length) :: line
      integer :: i, kind, language
      logical :: masked

      language = merge(2, 1, m%polish)
      kind = 0
      masked = .false.
      do i = 1, size(m%requests)
         if (mod(step, m%requests(i)%every) /= 0 .and. step /= instant_count(m) - 1) cycle
         row = row_by_hand(m, b, m%requests(i))
         if (kind == 0) call put_time(o, m, scales, step, language)
         if (row%kind /= kind) call put(o, trim(heads(row%kind, language)))
         kind = row%kind
         if (size(error) > 0) then
            line = row_line(row, m%degrees, scales, merge(0, 2, any(resting(row%links))), error(:, :, i), language)
         else
            line = row_line(row, m%degrees, scales, merge(0, 2, any(resting(row%links))), 0.0_qp*row%value, language)
         end if
         masked = masked .or. index(line, '?') > 0
         call put(o, line(:name_length + field_length*(6 + row%columns)))
      end do
      if (kind == 0 .and. any(resting)) call put_time(o, m, scales, step, language)
      if (any(resting)) call put(o, ' *** '//trim(singular_words(language)))
      if (masked) call put(o, ' --- ?: '//trim(unknown_words(language)))
   end subroutine put_tables

   !> The line over the tables.
   subroutine put_time(o, m, scales, step, language)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(hand_scales_t), intent(in) :: scales
      integer, intent(in) :: step, language
      character(12) :: number

      write (number, '(i0)') step
      call put(o, '')
      call put(o, trim(instant_words(language))//' '//trim(number)//'   T = ' &
         //trim(adjustl(number_by_hand(real(instant(m, step), qp), 0.0_qp, scales%time_decimals, scales%time_power))))
   end subroutine put_time

   !> The line of `row`, of which derivatives up to `known` exist.
   function row_line(row, degrees, scales, known, error, language) result(line)
      type(hand_row_t), intent(in) :: row
      logical, intent(in) :: degrees
      type(hand_scales_t), intent(in) :: scales
      integer, intent(in) :: known, language
      real(qp), intent(in) :: error(3, 0:2)
      character(line_length) :: line
      real(qp) :: unit
      integer :: c, k, first, what

      line = ' '//row%name
      do k = 0, 2
         do c = 1, row%columns
            first = name_length + field_length*(3*k + c - 1) + 1
            what = merge(1, 2, row%is_length(c))
            unit = 1.0_qp
            if (degrees .and. what == 2) unit = degree_q
            line(first:first + field_length - 1) = repeat(' ', field_length - len(none_words))//none_words(language)
            if (k <= known) line(first:first + field_length - 1) = number_by_hand(row%value(c, k)/unit, &
               error(c, k)/unit, scales%decimals(what, k), scales%power(what, k))
         end do
      end do
   end function row_line
end module hand_tables
