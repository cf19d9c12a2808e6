!> What card PROVE has proved: a line for each printed instant, with what led to it since the one before; why instants
!> are not proved; and the counts.
module proof_table
   use kinds, only: wp
   use mechanism, only: shown_links, instant
   use motion, only: mark_none
   use independent, only: set_t
   use proofs, only: proofs_t, reason_t
   use names, only: listed
   use listing, only: words_of_mark
   use listing_layout, only: layout_t, put_folded
   use table, only: right
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use number_format, only: whole
   use phrases
   implicit none
   private
   public :: put_proofs

   integer, parameter :: number_width = 12

contains

   !> Writes what is proved after the last instant of a set.
   subroutine put_proofs(o, l, p, m)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(proofs_t), intent(in) :: p
      class(set_t), intent(in) :: m
      character(:), allocatable :: start, gap
      integer :: i

      call put(o, '')
      call put(o, ' '//phrase(say_proof, m%polish))
      call put(o, column(phrase(say_instant, m%polish))//column('T')//column(phrase(say_parts, m%polish)) &
         //column(phrase(say_tube, m%polish))//column(phrase(say_position, m%polish)) &
         //column(phrase(say_velocity, m%polish))//'  '//column(phrase(say_acceleration, m%polish)))
      do i = 1, p%count
         associate (line => p%lines(i))
            start = column(whole(line%step))//column(time_text(l, instant(m, line%step)))
            if (line%is_proved) then
               call put(o, start//column(whole(line%parts))//column(rounded_up(line%tube)) &
                  //column(rounded_up(line%bounds(0)))//column(rounded_up(line%bounds(1))) &
                  //'  '//column(rounded_up(line%bounds(2))))
            else
               call put(o, start//'   '//phrase(say_not_proved, m%polish))
            end if
         end associate
      end do
      do i = 1, size(p%reasons)
         associate (r => p%reasons(i))
            call put_folded(o, ' *** ', phrase(say_instant, m%polish)//' '//whole(r%step)//', T = ' &
               //time_text(l, instant(m, r%step))//': '//phrase(say_not_proved, m%polish)//': '//words_of(r, m))
         end associate
      end do
      if (p%instants - p%proved > size(p%reasons)) call put(o, ' *** '//phrase(say_not_proved, m%polish) &
         //': '//whole(p%instants - p%proved))
      gap = ''
      if (p%gap > 0.0_wp) gap = ',  '//phrase(say_closure_error_of, m%polish)//' '//rounded_up(p%gap)
      call put(o, ' '//phrase(say_proved, m%polish)//' '//whole(p%proved)//' / '//whole(p%instants) &
         //',  '//phrase(say_parts, m%polish)//' '//whole(sum(p%lines(:p%count)%parts)) &
         //',  '//phrase(say_tube, m%polish)//' '//rounded_up(maxval([0.0_wp, p%lines(:p%count)%tube]))//gap)
   end subroutine put_proofs

   !> Tells why an instant is not proved.
   function words_of(r, m) result(words)
      type(reason_t), intent(in) :: r
      class(set_t), intent(in) :: m          !< the set
      character(:), allocatable :: words

      if (r%mark /= mark_none) then
         words = words_of_mark(r%mark, r%singularity, m%polish)
      else if (r%is_crossed) then
         words = phrase(say_change_inside, m%polish)
      else
         words = phrase(say_near_singular, m%polish)
         if (r%too_many > 0) words = phrase(say_too_wide, m%polish)//' '//whole(r%too_many)
         if (.not. allocated(r%links)) return
         associate (part => m%parts(r%part))
            if (size(r%links) > 0) words = phrase(say_links, m%polish)//' ' &
               //listed(part%links(shown_links(part, r%links))%name, m%polish)//': '//words
         end associate
      end if
   end function words_of

   !> `text` at the right of a column.
   pure function column(text)
      character(*), intent(in) :: text       !< at most as long as the column
      character(number_width) :: column

      column = right(text, number_width)
   end function column

   !> `x` with one digit, rounded up; 0 is exact.
   pure function rounded_up(x) result(text)
      real(wp), intent(in) :: x              !< at least 0
      character(:), allocatable :: text
      character(8) :: field
      real(wp) :: large
      integer :: first, power, digit

      text = '0'
      if (.not. x > 0.0_wp) return
      ! Numbers next to the end of the range are none.
      large = min(max(x, tiny(x)/epsilon(x)**2), huge(x)*epsilon(x)**2)
      ! Of the power of two: its own or one less.
      first = floor((exponent(large) - 1)*log10(2.0_wp))
      do power = first, first + 1
         digit = max(1, ceiling(large/10.0_wp**power))
         if (digit <= 9) exit
      end do
      write (field, '(i0, a, sp, i0.2)') digit, '.E', max(-999, min(power, 999))
      text = trim(field)
   end function rounded_up
end module proof_table
