!> Tests. The table of COLUMN cards as the listing must print it, from closed forms in real128: a line for each instant.
!> In the decks of input/ no line is too long, no instant has a flag, and of ratios alone a derivative is asked for.
module expected_columns
   use mechanism, only: instant_count, instant, drive_angle, drive_relangle
   use quad_jet, only: qp, jet_t, degree_q
   use jet_drives, only: drive_jet
   use closed_forms_dyads, only: body_t
   use expected_scales, only: listed_t
   use expected_numbers, only: number_by_hand, power_text, field_length
   use expected_links, only: move_links_to
   use expected_rows, only: expected_row_t, column_word, drive_word, listed_name
   use expected_ratios, only: row_at, unit_of
   use text_output, only: output_t, put
   implicit none
   private
   public :: put_columns_by_hand

   !> Lines of heads: two names, a power of ten, a unit; and the longest line.
   integer, parameter :: heads = 4, line_length = 120

contains

   !> The table: times, drives, and the numbers that the cards name.
   subroutine put_columns_by_hand(o, m)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(body_t) :: links(size(m%links), instant_count(m%mechanism_t))
      type(expected_row_t) :: row
      type(jet_t) :: f
      real(qp) :: t(instant_count(m%mechanism_t)), x(instant_count(m%mechanism_t))
      character(line_length) :: line(1 - heads:instant_count(m%mechanism_t))
      character(:), allocatable :: fault, word
      integer :: i, step, used

      if (.not. allocated(m%columns)) return
      t = [(real(instant(m%mechanism_t, step - 1), qp), step=1, size(t))]
      do step = 1, size(t)
         links(:, step)%phi%v = real(m%links%position(3), qp)
         if (step > 1) links(:, step) = links(:, step - 1)
         call move_links_to(m%name, m, t(step), links(:, step), fault)
      end do

      line = ''
      used = 0
      call put_column('', 'T', trim(m%time_unit), t, m%scales%time_decimals, m%scales%time_power)
      ! Room for the flag of an instant.
      used = used + 1
      do i = 1, size(m%drives)
         word = drive_word(m, m%drives(i))
         do step = 1, size(t)
            f = drive_jet(m%drives(i), t(step))
            x(step) = f%v
         end do
         associate (what => merge(2, 1, any(m%drives(i)%kind == [drive_angle, drive_relangle])))
            if (what == 2 .and. m%degrees) x = x/degree_q
            call put_column(word(:index(word, ' ') - 1), word(index(word, ' ') + 1:), unit_of(m, what, 0), x, &
               m%scales%decimals(what, 0), m%scales%power(what, 0))
         end associate
      end do
      do i = 1, size(m%columns)
         associate (at => m%columns(i)%at, request => m%requests(m%columns(i)%request))
            do step = 1, size(t)
               row = row_at(m, t(step), links(:, step), request)
               x(step) = row%value(at(1), at(2))
            end do
            associate (what => row%dimension(at(1)))
               if (what == 2 .and. m%degrees) x = x/degree_q
               call put_column(listed_name(row, m%polish), column_word(row, at(1), at(2), m%polish), &
                  unit_of(m, what, at(2)), x, m%scales%decimals(what, at(2)), m%scales%power(what, at(2)))
            end associate
         end associate
      end do

      call put(o, '')
      do step = lbound(line, 1), ubound(line, 1)
         if (line(step) /= '') call put(o, trim(line(step)))
      end do

   contains

      !> Appends a column to the lines: two names, a unit, and the numbers `x` over a power of ten.
      subroutine put_column(above, below, unit, x, decimals, power)
         character(*), intent(in) :: above, below, unit
         real(qp), intent(in) :: x(:)
         integer, intent(in) :: decimals, power
         character(line_length) :: cells(lbound(line, 1):ubound(line, 1))
         integer :: k, width

         cells(:0) = [character(line_length) :: above, below, power_text(power), unit]
         width = max(field_length, 2 + maxval(len_trim(cells(:0))))
         cells(1:) = [(number_by_hand(x(k), 0.0_qp, decimals, power), k=1, size(x))]
         do k = lbound(line, 1), ubound(line, 1)
            line(k)(used + width - len_trim(cells(k)) + 1:used + width) = cells(k)
         end do
         used = used + width
      end subroutine put_column
   end subroutine put_columns_by_hand
end module expected_columns
